# SPDX-License-Identifier: Apache-2.0
# The BVH alone, for one instruction set: tests and benchmarks link it without the rest of the kernel.
set(FATHOM_BVH_SOURCES bvh.cpp builder/binary.cpp builder/build.cpp builder/child_order.cpp builder/chunk.cpp builder/collapse.cpp
  builder/cost.cpp builder/items.cpp builder/large_set.cpp builder/leaf_data.cpp builder/morton.cpp builder/motion.cpp
  builder/occlusion.cpp builder/reinsertion.cpp builder/spatial.cpp builder/split.cpp builder/treelet.cpp)
list(TRANSFORM FATHOM_BVH_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/src/geometry/bvh/)

# Compiles the traversal apart from the builder, so that the builder has no influence on its machine code.
function(fathom_bvh_unity target)
  fathom_unity(${target})
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/geometry/bvh/bvh.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(fathom_bvh_library name isa)
  add_library(${name} STATIC ${FATHOM_BVH_SOURCES})
  target_link_libraries(${name} PUBLIC fathom_flags fathom_float fathom_base TBB::tbb)
  target_compile_options(${name} PUBLIC ${FATHOM_ISA_FLAGS_${isa}})
  target_compile_definitions(${name} PUBLIC FATHOM_LANE_PAIRS=${FATHOM_BVH_PAIRS_${isa}})
  fathom_bvh_unity(${name})
  # GCC 12's own AVX-512 headers cause these warnings.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${name} PUBLIC -Wno-uninitialized -Wno-maybe-uninitialized)
  endif()
endfunction()
