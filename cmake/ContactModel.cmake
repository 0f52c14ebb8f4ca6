# The model without FMI, for C programs: contact_model_library(<Scene>) makes libcontact_<Scene>.a, event_driven only and for
# the C library alone. `cmake --install` brings it with its headers and a package for CMake:
#   find_package(contact_fmus REQUIRED)
#   target_link_libraries(mine PRIVATE contact_fmus::SphereSphere)
# The libraries of two scenes have the same names inside: one for each program.
set(CONTACT_MODEL_SCENES SphereSphere SphereCylinder SpherePlane
    CACHE STRING "Scenes to install as libraries for C, without FMI")
set(component COMPONENT c) # `cmake --install build --component c` brings nothing else

function(contact_model_library name)
    set(folder "${CONTACT_SCENE_FOLDER}/${name}")
    include("${folder}/scene.cmake")
    set(SCENE_HAS_CVODE OFF)
    contact_scene_sources("${folder}" sources)
    set(target contact_model_${name})
    add_library(${target} STATIC ${sources})
    contact_compile_options(${target})
    target_include_directories(${target} PRIVATE "${CONTACT_SOURCE_FOLDER}" "${folder}"
        INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/contact_fmus>")
    target_link_libraries(${target} PUBLIC m)
    contact_leave_out_parts(${target})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME contact_${name} EXPORT_NAME ${name}
        POSITION_INDEPENDENT_CODE ON UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
    install(TARGETS ${target} EXPORT contact_fmus ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" ${component})
endfunction()

foreach(scene ${CONTACT_MODEL_SCENES})
    if(TARGET ${scene})
        contact_model_library(${scene})
    endif()
endforeach()

# model.h and what it includes.
foreach(header model/model.h model/variable.h integrator/step_request.h math/compiler.h)
    get_filename_component(place "${header}" DIRECTORY)
    install(FILES "${CONTACT_SOURCE_FOLDER}/${header}"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/contact_fmus/${place}" ${component})
endforeach()

include(CMakePackageConfigHelpers)
set(package "${CMAKE_INSTALL_LIBDIR}/cmake/contact_fmus")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/contact_fmusConfigVersion.cmake"
    COMPATIBILITY SameMinorVersion)
install(EXPORT contact_fmus NAMESPACE contact_fmus:: FILE contact_fmusConfig.cmake DESTINATION "${package}" ${component})
install(FILES "${PROJECT_BINARY_DIR}/contact_fmusConfigVersion.cmake" DESTINATION "${package}" ${component})
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DATADIR}/contact-fmus" ${component})
