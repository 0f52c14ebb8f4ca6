# add_contact_fmu(scene.toml): the FMUs of one scene, <build>/fmus/<Scene>.fmu for FMI 2.0 and, unless CONTACT_FMI3 is
# OFF, <build>/fmus-fmi3/<Scene>.fmu for FMI 3.0. They differ in the adapter and the description, in nothing else.
#
#   configure   modelDescription/generate.py writes <build>/scenes/<Scene>/: modelDescription.xml (FMI 2.0),
#               modelDescription3.xml (FMI 3.0), scene.h, scene_variables.c, documentation/, resources/scene.json and
#               scene.cmake (SCENE_NAME, SCENE_ANY_FREE, SCENE_HAS_CVODE, SCENE_HAS_CYLINDER, SCENE_HAS_CAPS,
#               SCENE_HAS_PLANE, SCENE_HAS_CURVED, SCENE_HAS_HERTZ, SCENE_HAS_PRESCRIBED, SCENE_HAS_RESTITUTION,
#               SCENE_HAS_ROTATION, SCENE_HAS_FRICTION, SCENE_HAS_ROLLING, SCENE_HAS_MINDLIN); units.txt there lists the sources that the scene has
#   compile     all of fmu_src, with the adapters of both versions, as one unit against that scene.h
#   link        the unit once for each version, which exports its own functions and drops what only the other one calls
#               -> <build>/libraries/<Scene>.so, libraries/fmi3/<Scene>.so
#   sources     the same code as one file -> <Scene folder>/sources/, sources3/ (cmake/amalgamate.py)
#   pack        the library, stripped, with description, documentation and sources into a ZIP
#
# contact_scene_library(<Scene>) makes the same code a static library for C tests that need a scene.
set(CONTACT_FMU_FOLDER "${PROJECT_BINARY_DIR}/fmus")
set(CONTACT_FMI3_FMU_FOLDER "${PROJECT_BINARY_DIR}/fmus-fmi3")
set(CONTACT_LIBRARY_FOLDER "${PROJECT_BINARY_DIR}/libraries")
set(CONTACT_SCENE_FOLDER "${PROJECT_BINARY_DIR}/scenes")
add_custom_target(fmus) # all for FMI 2.0
set(contact_description_folder "${PROJECT_SOURCE_DIR}/modelDescription")

# zig's compiler is clang, but it takes fewer options: no padding of pages to choose, and link-time optimization
# without the tools that CMake asks clang for.
get_filename_component(contact_compiler "${CMAKE_C_COMPILER}" NAME_WE)
string(COMPARE EQUAL "${contact_compiler}" zig CONTACT_ZIG)

# gcc takes the unit for the whole program, which optimizes it as link-time optimization would in three quarters of the
# time. clang has only that.
set(CONTACT_IPO OFF)
string(COMPARE EQUAL "${CMAKE_C_COMPILER_ID}" GNU CONTACT_GCC)
if(NOT CONTACT_ZIG AND NOT CONTACT_GCC)
    include(CheckIPOSupported)
    check_ipo_supported(RESULT CONTACT_IPO OUTPUT contact_ipo_complaint LANGUAGES C)
    if(NOT CONTACT_IPO)
        message(STATUS "No link-time optimization: the libraries keep some code for what their scenes pin")
    endif()
endif()

# Only tests read debug information, and only before the libraries are stripped; it is a third of the time of compiling.
set(CONTACT_DEBUG_INFORMATION ON)
if(CONTACT_STRIP AND (CONTACT_SCENES OR NOT BUILD_TESTING))
    set(CONTACT_DEBUG_INFORMATION OFF)
endif()

# The folder for binaries inside an FMU, FMI 2.0.5 section 2.2 and FMI 3.0.2 section 2.5.1.4, and the ending of their names.
set(contact_processor x86_64)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64|ARM64")
    set(contact_processor aarch64)
endif()
set(contact_ending .so)
set(contact_system linux)
set(contact_platform_fmi2 linux64)
if(WIN32)
    set(contact_ending .dll)
    set(contact_system windows)
    set(contact_platform_fmi2 win64)
elseif(APPLE)
    set(contact_ending .dylib)
    set(contact_system darwin)
    set(contact_platform_fmi2 darwin64)
elseif(contact_processor STREQUAL "aarch64")
    set(contact_platform_fmi2 aarch64-linux) # the names of FMI 3.0, as most importers take them
endif()
set(contact_platform_fmi3 ${contact_processor}-${contact_system})

execute_process(COMMAND "${Python3_EXECUTABLE}" -c "import importlib.util; assert importlib.util.find_spec('fmpy')"
    RESULT_VARIABLE contact_no_fmpy OUTPUT_QUIET ERROR_QUIET)
string(COMPARE EQUAL "${contact_no_fmpy}" 0 CONTACT_HAS_FMPY)
if(NOT CONTACT_HAS_FMPY)
    message(STATUS "FMUs without reference results: no fmpy in ${Python3_EXECUTABLE}")
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
    set(choices "")
    if(CONTACT_CHOICES) # instead of what the scene file says
        set(choices --choices "${CONTACT_CHOICES}")
    endif()
    execute_process(
        COMMAND "${Python3_EXECUTABLE}" -B "${contact_description_folder}/generate.py"
            --scene "${scene}" --output "${folder}" --icon "${folder}/model.png" ${choices}
        RESULT_VARIABLE status ERROR_VARIABLE complaint)
    if(status)
        message(FATAL_ERROR "${complaint}")
    elseif(complaint)
        message(WARNING "${complaint}")
    endif()
    set(${result} "${folder}" PARENT_SCOPE)
endfunction()

# What the scene whose scene.cmake has been read needs; the contact folder, which knows no scene, hears of it here.
function(contact_leave_out_parts target)
    target_compile_definitions(${target} PRIVATE CONTACT_PARTS)
    foreach(what CYLINDER SKEW CAPS PLANE TORUS COMPOUND CURVED HERTZ PRESCRIBED RESTITUTION ROTATION ROLLING MINDLIN)
        target_compile_definitions(${target} PRIVATE "CONTACT_ANY_${what}=$<BOOL:${SCENE_HAS_${what}}>")
    endforeach()
endfunction()

# What every compilation of the scene's code needs, whether it becomes an FMU or a test library.
function(contact_scene_options target folder has_cvode)
    contact_compile_options(${target})
    contact_sanitize(${target})
    target_include_directories(${target} PUBLIC "${CONTACT_SOURCE_FOLDER}" "${folder}")
    if(NOT WIN32) # whose C library has the mathematics
        target_link_libraries(${target} PUBLIC m)
    endif()
    if(has_cvode)
        target_link_libraries(${target} PUBLIC contact::sundials)
        target_compile_definitions(${target} PRIVATE CONTACT_WITH_CVODE)
    endif()
    contact_leave_out_parts(${target})
    set_target_properties(${target} PROPERTIES C_VISIBILITY_PRESET hidden POSITION_INDEPENDENT_CODE ON)
endfunction()

# The sources that the scene of SCENE_ANY_FREE, SCENE_HAS_GENERAL and SCENE_HAS_CVODE needs.
function(contact_scene_sources folder result)
    set(sources ${CONTACT_MODEL_SOURCES} "${folder}/scene_variables.c")
    if(SCENE_ANY_FREE)
        list(APPEND sources ${CONTACT_FREE_SOURCES})
        if(SCENE_HAS_HERTZ)
            list(APPEND sources ${CONTACT_HERTZ_SOURCES})
        endif()
        if(SCENE_HAS_GENERAL)
            list(APPEND sources ${CONTACT_GENERAL_SOURCES})
        endif()
        if(SCENE_HAS_CVODE)
            list(APPEND sources ${CONTACT_CVODE_SOURCES})
        endif()
    endif()
    if(SCENE_HAS_CAPS OR SCENE_HAS_SKEW)
        list(APPEND sources ${CONTACT_ZONES_SOURCES})
    endif()
    set(${result} ${sources} PARENT_SCOPE)
endfunction()

function(add_contact_fmu scene)
    contact_generate_scene("${scene}" folder)
    include("${folder}/scene.cmake")
    foreach(target ${SCENE_NAME} ${SCENE_NAME}_fmu)
        if(TARGET ${target})
            message(FATAL_ERROR "${scene}: 'name' is '${SCENE_NAME}', but this build has another target "
                "'${target}' (allowed: any other name)")
        endif()
    endforeach()
    set_property(GLOBAL APPEND PROPERTY CONTACT_SCENES ${SCENE_NAME})

    contact_scene_sources("${folder}" sources)
    list(JOIN sources "\n" model) # for the architecture tests
    list(JOIN CONTACT_FMI2_SOURCES "\n" fmi2)
    list(JOIN CONTACT_FMI3_SOURCES "\n" fmi3)
    file(CONFIGURE OUTPUT "${folder}/units.txt" CONTENT "${model}\n${fmi2}\n" @ONLY)
    file(CONFIGURE OUTPUT "${folder}/units3.txt" CONTENT "${model}\n${fmi3}\n" @ONLY)

    contact_fmu_sources(${SCENE_NAME} "${folder}" 2 units.txt sources ${sources} ${CONTACT_FMI2_SOURCES})
    contact_scene_units("${folder}" ${sources})
    contact_fmu_library(${SCENE_NAME} "${folder}" fmi2 "${CONTACT_LIBRARY_FOLDER}")
    contact_fmu_reference(${SCENE_NAME} "${folder}" reference)
    contact_pack_fmu(${SCENE_NAME} "${folder}" "${CONTACT_FMU_FOLDER}/${SCENE_NAME}.fmu"
        "binaries/${contact_platform_fmi2}" modelDescription.xml
        "model.png=${folder}/model.png" "sources=${folder}/sources"
        "terminalsAndIcons=${folder}/terminals2" ${reference})
    add_dependencies(fmus ${SCENE_NAME}_fmu)
    if(CONTACT_FMI3)
        contact_fmu_sources(${SCENE_NAME}_fmi3 "${folder}" 3 units3.txt sources3 ${sources} ${CONTACT_FMI3_SOURCES})
        contact_fmu_library(${SCENE_NAME}_fmi3 "${folder}" fmi3 "${CONTACT_LIBRARY_FOLDER}/fmi3")
        contact_pack_fmu(${SCENE_NAME}_fmi3 "${folder}" "${CONTACT_FMI3_FMU_FOLDER}/${SCENE_NAME}.fmu"
            "binaries/${contact_platform_fmi3}" modelDescription3.xml
            "sources=${folder}/sources3" "terminalsAndIcons=${folder}/terminals3")
    endif()
endfunction()

# contact_scene_units(scene_folder source...): the code of the scene of SCENE_NAME, target <Scene>_code, as one unit, so that
# what the scene pins reaches every function and what nobody calls any more goes. It serves both versions of FMI, as
# <Scene>_code_fmi2 and <Scene>_code_fmi3 do each where only the marks in the headers say what is exported.
function(contact_scene_units folder)
    if(WIN32 OR APPLE)
        contact_scene_unit(${SCENE_NAME}_code_fmi2 "${folder}" ${ARGN} ${CONTACT_FMI2_SOURCES})
        if(CONTACT_FMI3)
            contact_scene_unit(${SCENE_NAME}_code_fmi3 "${folder}" ${ARGN} ${CONTACT_FMI3_SOURCES})
        endif()
        return()
    endif()
    set(sources ${ARGN} ${CONTACT_FMI2_SOURCES})
    if(CONTACT_FMI3)
        list(APPEND sources ${CONTACT_FMI3_SOURCES})
        list(REMOVE_DUPLICATES sources)
    endif()
    contact_scene_unit(${SCENE_NAME}_code "${folder}" ${sources})
endfunction()

function(contact_scene_unit target folder)
    add_library(${target} OBJECT EXCLUDE_FROM_ALL ${ARGN})
    contact_library_options(${target} "${folder}")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
    foreach(fmi fmi2 fmi3)
        if(TARGET contact::${fmi}_headers)
            target_link_libraries(${target} PRIVATE contact::${fmi}_headers)
        endif()
    endforeach()
    if(CONTACT_GCC)
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-fwhole-program>)
    endif()
endfunction()

# contact_fmu_library(target scene_folder fmi2|fmi3 output_folder): the library of the scene of SCENE_NAME.
function(contact_fmu_library target folder fmi output)
    set(exports "${PROJECT_SOURCE_DIR}/cmake/${fmi}_exports.map")
    set(unit ${SCENE_NAME}_code)
    if(TARGET ${unit}_${fmi})
        set(unit ${unit}_${fmi})
    endif()
    set(kind MODULE)
    if(APPLE) # whose modules are no libraries that an importer may link
        set(kind SHARED)
    endif()
    add_library(${target} ${kind} $<TARGET_OBJECTS:${unit}>)
    contact_library_options(${target} "${folder}")
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE C
        OUTPUT_NAME ${SCENE_NAME} PREFIX "" SUFFIX ${contact_ending} LIBRARY_OUTPUT_DIRECTORY "${output}"
        LINK_DEPENDS "${exports}")
    contact_link_options(${target} "${exports}")
    if(CONTACT_ZIG AND WIN32)
        contact_link_windows(${target})
    endif()
endfunction()

# What the unit and the libraries made of it are compiled and linked with.
function(contact_library_options target folder)
    contact_scene_options(${target} "${folder}" ${SCENE_HAS_CVODE})
    # The linker tells clang's optimizer from the version script that no one else calls the inner functions: only
    # then may their parameters become constants.
    set_target_properties(${target} PROPERTIES INTERPROCEDURAL_OPTIMIZATION_RELEASE ${CONTACT_IPO})
    # Nothing here throws or is thrown through: no unwind tables, a tenth of a force element. The debug information
    # has its own. The linker's optimizer is told too. Windows wants the tables of every function.
    set(no_unwinding -fno-asynchronous-unwind-tables -fno-unwind-tables)
    if(WIN32)
        set(no_unwinding "")
    endif()
    # zig: no debug information, since there may be no program that strips it. Its linker for macOS has no link-time
    # optimization. Format 4: readelf of Debian 12 mixes up the file names of clang's format 5.
    if(NOT CONTACT_ZIG AND CONTACT_DEBUG_INFORMATION)
        target_compile_options(${target} PRIVATE -gdwarf-4)
    elseif(CONTACT_ZIG AND NOT APPLE)
        target_compile_options(${target} PRIVATE -flto)
        target_link_options(${target} PRIVATE -flto)
    endif()
    # One FMU for all platforms is to be small: there size is worth more than the last tenth of speed. Digits do not
    # depend on it. -Oz means what zig's own -Os does not pass on; on x86-64 Linux, where most runs are, functions are
    # still put into their callers. sqrt without errno is one instruction.
    if(CONTACT_ZIG AND CMAKE_CROSSCOMPILING)
        target_compile_options(${target} PRIVATE -Os -fno-math-errno -fomit-frame-pointer)
        if(NOT contact_platform_fmi2 STREQUAL "linux64")
            target_compile_options(${target} PRIVATE "SHELL:-Xclang -Oz" "SHELL:-mllvm -inline-threshold=0")
        endif()
    endif()
    target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections ${no_unwinding})
    target_link_options(${target} PRIVATE ${no_unwinding})
endfunction()

# The C library of Windows itself, and nothing of the compiler's: windows_runtime.c says why.
function(contact_link_windows target)
    set(runtime "${PROJECT_SOURCE_DIR}/cmake/platforms/windows_runtime.c")
    target_sources(${target} PRIVATE "${runtime}")
    # Not optimized with the rest: the optimizer would make calls of memcpy, of which it takes no note then.
    set_source_files_properties("${runtime}" PROPERTIES
        SKIP_UNITY_BUILD_INCLUSION ON COMPILE_OPTIONS "-fno-builtin;-fno-lto")
    target_link_options(${target} PRIVATE -nostdlib)
    target_link_libraries(${target} PRIVATE ucrtbase)
endfunction()

# The functions of FMI are exported and nothing else: a host that links a SUNDIALS of its own would else take over the
# FMU's calls. Windows and macOS go by the marks in the FMI headers alone, ELF by the version script.
function(contact_link_options target exports)
    if(APPLE)
        target_link_options(${target} PRIVATE -Wl,-dead_strip)
        if(CONTACT_ZIG) # whose -s leaves the names of inner functions in: a tenth of the file
            target_link_options(${target} PRIVATE -Wl,-x)
        endif()
        set_target_properties(${target} PROPERTIES MACOSX_RPATH ON) # its name, not its place here, is inside
        return()
    endif()
    target_link_options(${target} PRIVATE -Wl,--gc-sections -Wl,--as-needed)
    if(WIN32)
        return()
    endif()
    # Code and constants share their pages: the padding between them would be a seventh of a force element.
    target_link_options(${target} PRIVATE -Wl,--build-id=none $<$<NOT:$<BOOL:${CONTACT_ZIG}>>:-Wl,-z,noseparate-code>
        "-Wl,--version-script=${exports}")
    if(NOT CONTACT_SANITIZE) # whose functions only the host's process has
        target_link_options(${target} PRIVATE -Wl,-z,defs)
    endif()
endfunction()

# contact_fmu_sources(target scene_folder 2|3 list_of_units folder source...): target <target>_sources.
function(contact_fmu_sources target folder fmi units output)
    set(made "${folder}/${output}/contact.c")
    get_target_property(headers contact_fmi${fmi}_headers INTERFACE_INCLUDE_DIRECTORIES)
    file(GLOB_RECURSE own_headers CONFIGURE_DEPENDS "${CONTACT_SOURCE_FOLDER}/*.h")
    add_custom_command(OUTPUT "${made}"
        COMMAND "${Python3_EXECUTABLE}" -B "${PROJECT_SOURCE_DIR}/cmake/amalgamate.py" "${folder}/${units}"
            "${folder}" "${CONTACT_SOURCE_FOLDER}" "${headers}" ${fmi} "${folder}/${output}"
        DEPENDS ${ARGN} ${own_headers} "${folder}/scene.h" "${folder}/scene.cmake" "${folder}/${units}"
            "${PROJECT_SOURCE_DIR}/cmake/amalgamate.py" "${PROJECT_SOURCE_DIR}/cmake/prune.py"
        COMMENT "Joining the sources of ${target}" VERBATIM)
    add_custom_target(${target}_sources DEPENDS "${made}")
endfunction()

# contact_fmu_reference(target scene_folder result): reference results by fmi-ls-ref, as members for contact_pack_fmu. They
# are made by running the library, where that can be done: on Linux (x86-64), with fmpy, without sanitizers.
function(contact_fmu_reference target folder result)
    set(${result} "" PARENT_SCOPE)
    if(NOT CONTACT_HAS_FMPY OR CONTACT_SANITIZE OR NOT contact_platform_fmi2 STREQUAL "linux64"
            OR NOT "${CMAKE_HOST_SYSTEM_NAME}-${CMAKE_HOST_SYSTEM_PROCESSOR}" STREQUAL "Linux-x86_64")
        return()
    endif()
    set(output "${folder}/reference")
    set(script "${PROJECT_SOURCE_DIR}/cmake/make_reference.py")
    add_custom_command(OUTPUT "${output}/fmi-ls-ref.txt"
        COMMAND "${Python3_EXECUTABLE}" -B "${script}" "$<TARGET_FILE:${target}>" ${contact_platform_fmi2}
            "${folder}" "${output}"
        DEPENDS ${target} "${script}" "${folder}/modelDescription.xml"
        COMMENT "Reference results of ${target}" VERBATIM)
    set(${result} "extra/org.fmi-standard.fmi-ls-ref=${output}/extra"
        "documentation/fmi-ls-ref.txt=${output}/fmi-ls-ref.txt" PARENT_SCOPE)
endfunction()

# contact_pack_fmu(target scene_folder X.fmu binaries_folder description [member=file...]): target <target>_fmu.
function(contact_pack_fmu target folder fmu binaries description)
    set(library "$<TARGET_FILE:${target}>")
    set(strip_command "")
    if(CONTACT_STRIP AND CMAKE_STRIP AND NOT CMAKE_CROSSCOMPILING)
        set(library "${CONTACT_LIBRARY_FOLDER}/stripped/${target}.so")
        file(MAKE_DIRECTORY "${CONTACT_LIBRARY_FOLDER}/stripped")
        set(strip_command COMMAND "${CMAKE_STRIP}" --strip-all -o "${library}" "$<TARGET_FILE:${target}>")
    endif()
    set(members "modelDescription.xml=${folder}/${description}" "documentation=${folder}/documentation"
        "resources/scene.json=${folder}/resources/scene.json"
        "${binaries}/${SCENE_NAME}${contact_ending}=${library}"
        "terminalsAndIcons/icon.png=${folder}/model.png" "terminalsAndIcons/icon.svg=${folder}/icon.svg" ${ARGN})
    file(GLOB licenses CONFIGURE_DEPENDS "${contact_description_folder}/documentation/licenses/*")
    foreach(license ${licenses})
        get_filename_component(license_name "${license}" NAME)
        if(SCENE_HAS_CVODE OR NOT license_name MATCHES "[Ss][Uu][Nn][Dd][Ii][Aa][Ll][Ss]")
            list(APPEND members "documentation/licenses/${license_name}=${license}")
        endif()
    endforeach()
    file(GLOB_RECURSE documentation CONFIGURE_DEPENDS "${folder}/documentation/*")
    set(made ${ARGN}) # of these, the one whose rule makes the others of its folder too
    list(TRANSFORM made REPLACE "^sources=.*" "\\0/contact.c")
    list(FILTER made INCLUDE REGEX "fmi-ls-ref.txt=|^sources=")
    list(TRANSFORM made REPLACE "^[^=]*=" "")
    add_custom_command(OUTPUT "${fmu}"
        ${strip_command}
        COMMAND "${Python3_EXECUTABLE}" -B "${PROJECT_SOURCE_DIR}/cmake/pack_fmu.py" "${fmu}" ${members}
        DEPENDS ${target} ${target}_sources "${PROJECT_SOURCE_DIR}/cmake/pack_fmu.py" "${folder}/${description}"
            "${folder}/resources/scene.json" ${documentation} ${licenses}
            "${folder}/model.png" "${folder}/icon.svg"
            "${folder}/terminals2/terminalsAndIcons.xml" "${folder}/terminals3/terminalsAndIcons.xml" ${made}
        COMMENT "Packing ${target}.fmu" VERBATIM)
    add_custom_target(${target}_fmu ALL DEPENDS "${fmu}")
    cmake_path(GET fmu PARENT_PATH fmu_folder)
    cmake_path(GET fmu_folder FILENAME fmu_folder)
    string(REPLACE "fmus" "contact-fmus" destination "${fmu_folder}")
    install(FILES "${fmu}" DESTINATION "${CMAKE_INSTALL_DATADIR}/${destination}")
endfunction()

# FMUs of scenes that this build had and has no more.
function(contact_remove_other_scenes)
    get_property(scenes GLOBAL PROPERTY CONTACT_SCENES)
    file(GLOB fmus "${CONTACT_FMU_FOLDER}/*.fmu" "${CONTACT_FMI3_FMU_FOLDER}/*.fmu")
    foreach(fmu ${fmus})
        get_filename_component(name "${fmu}" NAME_WE)
        if(NOT name IN_LIST scenes)
            message(STATUS "Removing ${fmu}: this build has no scene ${name} any more")
            file(REMOVE "${fmu}")
        endif()
    endforeach()
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
