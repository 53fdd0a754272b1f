# The rooms as libraries for other programs: cmake --install BUILD --component development, then find_package(clipgs).
# Not of the package: static libraries belong to the compiler that made them.

set(rooms core text volume light cinema splat section train bake asset tour measure pipeline study)
list(TRANSFORM rooms PREPEND clipgs_ OUTPUT_VARIABLE libraries)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/clipgs)

install(TARGETS ${libraries} clipgs_gdcm EXPORT clipgs ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/clipgs
        COMPONENT development EXCLUDE_FROM_ALL)
install(EXPORT clipgs NAMESPACE clipgs:: FILE clipgsTargets.cmake DESTINATION ${cmake_folder}
        COMPONENT development EXCLUDE_FROM_ALL)
foreach(room ${rooms})
  if(IS_DIRECTORY ${CMAKE_SOURCE_DIR}/src/${room})
    file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${room}/*.h)
    list(FILTER headers EXCLUDE REGEX "/(test_[a-z_]+|[a-z_]+_(test|fixture|kernel))\\.h$")
    install(FILES ${headers} DESTINATION ${clipgs_headers}/${room} COMPONENT development EXCLUDE_FROM_ALL)
  endif()
endforeach()

include(CMakePackageConfigHelpers)
write_basic_package_version_file(clipgsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES clipgsConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/clipgsConfigVersion.cmake DESTINATION ${cmake_folder}
        COMPONENT development EXCLUDE_FROM_ALL)

if(CLIPGS_TESTS AND NOT CLIPGS_SANITIZE)
  add_test(NAME FindPackage COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/find_package_test.sh ${CMAKE_BINARY_DIR})
  set_tests_properties(FindPackage PROPERTIES LABELS package TIMEOUT 300)
endif()
