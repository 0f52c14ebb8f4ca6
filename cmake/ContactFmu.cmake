# add_contact_fmu(scene.toml): the FMU of one scene, <build>/fmus/<Scene>.fmu.
#
#   configure   modelDescription/generate.py writes <build>/scenes/<Scene>/: modelDescription.xml, scene.h,
#               scene_variables.c, documentation/ and scene.cmake (SCENE_NAME, SCENE_ANY_FREE, SCENE_HAS_CVODE,
#               SCENE_HAS_CYLINDER); units.txt there lists the sources that the scene has
#   compile     all of fmu_src as one unit against that scene.h -> <build>/libraries/<Scene>.so
#   pack        the library, stripped, with description and documentation into a ZIP
#
# contact_scene_library(<Scene>) makes the same code a static library for C tests that need a scene.
set(CONTACT_FMU_FOLDER "${PROJECT_BINARY_DIR}/fmus")
set(CONTACT_LIBRARY_FOLDER "${PROJECT_BINARY_DIR}/libraries")
set(CONTACT_SCENE_FOLDER "${PROJECT_BINARY_DIR}/scenes")
set(contact_description_folder "${PROJECT_SOURCE_DIR}/modelDescription")

include(CheckIPOSupported)
check_ipo_supported(RESULT CONTACT_IPO OUTPUT contact_ipo_complaint LANGUAGES C)
if(NOT CONTACT_IPO)
    message(STATUS "No link-time optimization: the libraries keep some code for what their scenes pin")
endif()

# The folder for binaries inside an FMU, FMI 2.0.5 section 2.3.
set(contact_platform linux64)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
    set(contact_platform aarch64-linux)
endif()

# Whatever the generator reads makes CMake run again, and with it the generator.
file(GLOB_RECURSE contact_generator_inputs CONFIGURE_DEPENDS
    "${contact_description_folder}/*.py" "${contact_description_folder}/*.toml"
    "${contact_description_folder}/templates/*" "${contact_description_folder}/documentation/*"
    "${PROJECT_SOURCE_DIR}/LICENSE")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${contact_generator_inputs})

# Runs the generator, which leaves files that come out as they were alone, so that nothing is compiled again
# for them.
function(contact_generate_scene scene result)
    get_filename_component(stem "${scene}" NAME_WE)
    set(folder "${CONTACT_SCENE_FOLDER}/${stem}")
    execute_process(
        COMMAND "${Python3_EXECUTABLE}" -B "${contact_description_folder}/generate.py"
            --scene "${scene}" --output "${folder}"
        RESULT_VARIABLE status ERROR_VARIABLE complaint)
    if(status)
        message(FATAL_ERROR "${complaint}")
    endif()
    set(${result} "${folder}" PARENT_SCOPE)
endfunction()

# What every compilation of the scene's code needs, whether it becomes an FMU or a test library.
function(contact_scene_options target folder has_cvode)
    contact_compile_options(${target})
    contact_sanitize(${target})
    target_include_directories(${target} PUBLIC "${CONTACT_SOURCE_FOLDER}" "${folder}")
    target_link_libraries(${target} PUBLIC contact::fmi2_headers m)
    if(has_cvode)
        target_link_libraries(${target} PUBLIC contact::sundials)
    endif()
    if(NOT SCENE_HAS_CYLINDER) # the contact folder, which knows no scene, hears of it here
        target_compile_definitions(${target} PRIVATE CONTACT_SPHERES_ONLY)
    endif()
    set_target_properties(${target} PROPERTIES C_VISIBILITY_PRESET hidden POSITION_INDEPENDENT_CODE ON)
endfunction()

# The sources that the scene of SCENE_ANY_FREE and SCENE_HAS_CVODE needs.
function(contact_scene_sources folder result)
    set(sources ${CONTACT_MODEL_SOURCES} "${folder}/scene_variables.c")
    if(SCENE_ANY_FREE)
        list(APPEND sources ${CONTACT_FREE_SOURCES})
        if(SCENE_HAS_CVODE)
            list(APPEND sources ${CONTACT_CVODE_SOURCES})
        else()
            list(APPEND sources ${CONTACT_NO_CVODE_SOURCES})
        endif()
    else()
        list(APPEND sources ${CONTACT_GIVEN_SOURCES})
    endif()
    set(${result} ${sources} PARENT_SCOPE)
endfunction()

function(add_contact_fmu scene)
    contact_generate_scene("${scene}" folder)
    include("${folder}/scene.cmake")
    set_property(GLOBAL APPEND PROPERTY CONTACT_SCENES ${SCENE_NAME})

    contact_scene_sources("${folder}" sources)
    list(APPEND sources ${CONTACT_FMI2_SOURCES})
    list(JOIN sources "\n" units) # for the architecture tests
    file(CONFIGURE OUTPUT "${folder}/units.txt" CONTENT "${units}\n" @ONLY)
    add_library(${SCENE_NAME} MODULE ${sources})
    contact_scene_options(${SCENE_NAME} "${folder}" ${SCENE_HAS_CVODE})
    set_target_properties(${SCENE_NAME} PROPERTIES
        PREFIX "" SUFFIX ".so" LIBRARY_OUTPUT_DIRECTORY "${CONTACT_LIBRARY_FOLDER}"
        # One unit, so that what the scene pins reaches every function and what nobody calls any more goes.
        UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0
        # The linker tells the optimizer from the version script that no one else calls the inner functions: only
        # then may their parameters become constants.
        INTERPROCEDURAL_OPTIMIZATION_RELEASE ${CONTACT_IPO}
        LINK_DEPENDS "${PROJECT_SOURCE_DIR}/cmake/fmi2_exports.map")
    # Debug information goes when the library is stripped; until then tests read from it which lines have code
    # (format 4: readelf of Debian 12 mixes up the file names of clang's format 5).
    # Nothing here throws or is thrown through: no unwind tables, a tenth of a force element. The debug information
    # has its own. The linker's optimizer is told too.
    set(no_unwinding -fno-asynchronous-unwind-tables -fno-unwind-tables)
    target_compile_options(${SCENE_NAME} PRIVATE -gdwarf-4 -ffunction-sections -fdata-sections ${no_unwinding})
    target_link_options(${SCENE_NAME} PRIVATE ${no_unwinding})
    # Code and constants share their pages: the padding between them would be a seventh of a force element.
    # The version script hides SUNDIALS too: a host that links its own would else take over the FMU's calls.
    target_link_options(${SCENE_NAME} PRIVATE -Wl,--gc-sections -Wl,--as-needed -Wl,--build-id=none
        -Wl,-z,noseparate-code
        "-Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/fmi2_exports.map")
    if(NOT CONTACT_SANITIZE) # whose functions only the host's process has
        target_link_options(${SCENE_NAME} PRIVATE -Wl,-z,defs)
    endif()

    contact_pack_fmu(${SCENE_NAME} "${folder}" ${SCENE_HAS_CVODE})
endfunction()

function(contact_pack_fmu name folder has_cvode)
    set(library "$<TARGET_FILE:${name}>")
    set(strip_command "")
    if(CONTACT_STRIP AND CMAKE_STRIP)
        set(library "${CONTACT_LIBRARY_FOLDER}/stripped/${name}.so")
        file(MAKE_DIRECTORY "${CONTACT_LIBRARY_FOLDER}/stripped")
        set(strip_command COMMAND "${CMAKE_STRIP}" --strip-all -o "${library}" "$<TARGET_FILE:${name}>")
    endif()
    set(documents "${contact_description_folder}/documentation")
    set(members "modelDescription.xml=${folder}/modelDescription.xml" "documentation=${folder}/documentation"
        "binaries/${contact_platform}/${name}.so=${library}" "model.png=${documents}/model.png")
    file(GLOB licenses CONFIGURE_DEPENDS "${documents}/licenses/*")
    foreach(license ${licenses})
        get_filename_component(license_name "${license}" NAME)
        if(has_cvode OR NOT license_name MATCHES "[Ss][Uu][Nn][Dd][Ii][Aa][Ll][Ss]")
            list(APPEND members "documentation/licenses/${license_name}=${license}")
        endif()
    endforeach()
    set(fmu "${CONTACT_FMU_FOLDER}/${name}.fmu")
    file(GLOB_RECURSE documentation CONFIGURE_DEPENDS "${folder}/documentation/*")
    add_custom_command(OUTPUT "${fmu}"
        ${strip_command}
        COMMAND "${Python3_EXECUTABLE}" -B "${PROJECT_SOURCE_DIR}/cmake/pack_fmu.py" "${fmu}" ${members}
        DEPENDS ${name} "${PROJECT_SOURCE_DIR}/cmake/pack_fmu.py" "${folder}/modelDescription.xml"
            ${documentation} ${licenses} "${documents}/model.png"
        COMMENT "Packing ${name}.fmu" VERBATIM)
    add_custom_target(${name}_fmu ALL DEPENDS "${fmu}")
    install(FILES "${fmu}" DESTINATION "${CMAKE_INSTALL_DATADIR}/contact-fmus")
endfunction()

function(contact_scene_library name)
    if(TARGET ${name}_model)
        return()
    endif()
    set(folder "${CONTACT_SCENE_FOLDER}/${name}")
    include("${folder}/scene.cmake")
    contact_scene_sources("${folder}" sources)
    add_library(${name}_model STATIC ${sources})
    contact_scene_options(${name}_model "${folder}" ${SCENE_HAS_CVODE})
endfunction()
