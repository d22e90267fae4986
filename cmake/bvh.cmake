# SPDX-License-Identifier: Apache-2.0
# The BVH for one instruction set, which is part of the kernel; tests and benchmarks link it without the rest.
set(FATHOM_BVH_SOURCES bvh.cpp builder/binary.cpp builder/build.cpp builder/child_order.cpp builder/chunk.cpp builder/collapse.cpp
  builder/cost.cpp builder/items.cpp builder/large_set.cpp builder/leaf_data.cpp builder/morton.cpp builder/motion.cpp
  builder/occlusion.cpp builder/reinsertion.cpp builder/spatial.cpp builder/split.cpp builder/treelet.cpp)
list(TRANSFORM FATHOM_BVH_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/src/geometry/bvh/)

# fathom_bvh_ISA: an object library. Traversal uses 16 lanes on every instruction set, independent of the path loop, so
# the library has a lane width of its own.
function(fathom_bvh_library isa)
  set(target fathom_bvh_${isa})
  add_library(${target} OBJECT ${FATHOM_BVH_SOURCES})
  target_link_libraries(${target} PUBLIC fathom_flags fathom_float fathom_base TBB::tbb)
  target_compile_options(${target} PUBLIC ${FATHOM_ISA_FLAGS_${isa}} ${FATHOM_KERNEL_FLAGS})
  target_compile_definitions(${target} PUBLIC FATHOM_LANE_PAIRS=${FATHOM_BVH_PAIRS_${isa}})
  # The traversal is compiled apart from the builder, so that the builder has no influence on its machine code.
  fathom_unity(${target})
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/geometry/bvh/bvh.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
