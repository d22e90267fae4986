# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: the program, the library with its kernel libraries and modules, headers, desktop files, and the
# CMake package. All paths are relative, so the installed folder can be moved.
include(CMakePackageConfigHelpers)
set(FATHOM_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/fathom)

install(TARGETS fathom RUNTIME)
install(TARGETS fathom_library EXPORT fathom LIBRARY)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/fathom DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
install(FILES ${PROJECT_SOURCE_DIR}/docs/scene.schema.json ${PROJECT_SOURCE_DIR}/docs/scene-format.md
              ${PROJECT_SOURCE_DIR}/LICENSE
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/apps/desktop/fathom.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${PROJECT_SOURCE_DIR}/apps/desktop/fathom.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers)
install(FILES ${PROJECT_SOURCE_DIR}/apps/desktop/fathom.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)

# fathom::fathom for find_package(fathom). Libraries that fathom links are not exported.
install(EXPORT fathom FILE fathom-targets.cmake NAMESPACE fathom:: DESTINATION ${FATHOM_PACKAGE_FOLDER})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/fathom-config.cmake.in ${CMAKE_BINARY_DIR}/fathom-config.cmake
                              INSTALL_DESTINATION ${FATHOM_PACKAGE_FOLDER} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/fathom-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/fathom-config.cmake ${CMAKE_BINARY_DIR}/fathom-config-version.cmake
        DESTINATION ${FATHOM_PACKAGE_FOLDER})
