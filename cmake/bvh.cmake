# The acceleration structure alone, for one instruction set: tests and benchmarks link it without the kernel around it.
set(FATHOM_BVH_SOURCES bvh.cpp build/binary.cpp build/build.cpp build/chunk.cpp build/collapse.cpp build/cost.cpp
  build/items.cpp build/large_set.cpp build/leaf_data.cpp build/morton.cpp build/motion.cpp build/reinsertion.cpp
  build/slots.cpp build/spatial.cpp build/split.cpp build/stops.cpp build/treelet.cpp)
list(TRANSFORM FATHOM_BVH_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/src/geometry/bvh/)

function(fathom_bvh_library name isa)
  add_library(${name} STATIC ${FATHOM_BVH_SOURCES})
  target_link_libraries(${name} PUBLIC fathom_flags fathom_float fathom_scene TBB::tbb)
  target_compile_options(${name} PUBLIC ${FATHOM_ISA_FLAGS_${isa}})
  target_compile_definitions(${name} PUBLIC FATHOM_LANE_PAIRS=${FATHOM_BVH_PAIRS_${isa}})
  # GCC 12's own AVX-512 header warns.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${name} PUBLIC -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
endfunction()
