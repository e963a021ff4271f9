# What `cmake --install` and `cpack -G DEB` take: the program, the example scenes that were made, the documents.
include(GNUInstallDirs)

install(TARGETS lumel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Found by the program relative to itself (engine/app/example_scenes.cpp).
install(DIRECTORY ${CMAKE_BINARY_DIR}/assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lumel/assets
  FILES_MATCHING PATTERN "*.gltf" PATTERN "*.bin" PATTERN "*.png" PATTERN CMakeFiles EXCLUDE)
foreach(document README.md LICENSE CHANGELOG.md)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${document})
    install(FILES ${document} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lumel)
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the Lumel authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Loaded while running: a Vulkan driver, the panels' font, the compiler for shaders that are changed meanwhile.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "mesa-vulkan-drivers | vulkan-icd, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "glslang-tools, vulkan-validationlayers")
include(CPack)
