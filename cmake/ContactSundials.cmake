# Target contact::sundials: CVODE and serial vectors, static, position independent, without MPI.
#   CONTACT_SUNDIALS=auto    the bundled one of an installed Python package, or that which scripts/setup.sh --demo
#                            has unpacked in the build's folder; else the installed one when it is fit
#                            for an FMU; else upstream's
#   CONTACT_SUNDIALS=system  the installed one or an error that says why not
#   CONTACT_SUNDIALS=fetch   upstream at the commit below; -DFETCHCONTENT_SOURCE_DIR_SUNDIALS=<checkout> saves
#                            the download
#   CONTACT_SUNDIALS=none    no scene of this build needs CVODE
# For another platform than this one, auto is fetch: what is installed here would not do there.
set(CONTACT_SUNDIALS auto CACHE STRING "auto, system, fetch or none")
set_property(CACHE CONTACT_SUNDIALS PROPERTY STRINGS auto system fetch none)
if(CONTACT_SUNDIALS STREQUAL "none")
    return()
endif()

set(contact_sundials_commit c298f0f56c48eb8ce687d399e981ce09b3d0c36e) # v7.5.0

# In the Python package of this project (ContactPackage.cmake); a clone has none.
set(contact_bundled_sundials "${PROJECT_SOURCE_DIR}/sundials")
if(NOT EXISTS "${contact_bundled_sundials}")
    set(contact_bundled_sundials "${PROJECT_BINARY_DIR}/debian-sundials")
endif()

function(contact_use_bundled_sundials)
    add_library(contact_sundials INTERFACE)
    foreach(part cvode nvecserial core) # as in InstalledSundials.cmake
        if(EXISTS "${contact_bundled_sundials}/lib/libsundials_${part}.a")
            target_link_libraries(contact_sundials INTERFACE "${contact_bundled_sundials}/lib/libsundials_${part}.a")
        endif()
    endforeach()
    target_link_libraries(contact_sundials INTERFACE m)
    target_include_directories(contact_sundials SYSTEM INTERFACE "${contact_bundled_sundials}/include")
    target_compile_definitions(contact_sundials INTERFACE SUNDIALS_STATIC_DEFINE)
endfunction()

# Tries the installed SUNDIALS in a build of its own: the targets of a refused one would stand in the
# fallback's way.
function(contact_probe_installed_sundials)
    if(DEFINED CONTACT_SUNDIALS_FIT)
        return()
    endif()
    set(folder "${PROJECT_BINARY_DIR}/sundials_probe")
    string(STRIP "${CMAKE_C_COMPILER_ARG1}" argument) # the cc of `zig cc`
    set(compiler "${CMAKE_C_COMPILER}" ${argument})
    file(REMOVE_RECURSE "${folder}")
    execute_process(
        COMMAND "${CMAKE_COMMAND}" -S "${PROJECT_SOURCE_DIR}/cmake/sundials_probe" -B "${folder}"
            -G "${CMAKE_GENERATOR}"
            "-DCMAKE_MAKE_PROGRAM=${CMAKE_MAKE_PROGRAM}" "-DCMAKE_C_COMPILER=${compiler}"
            "-DCMAKE_TRY_COMPILE_CONFIGURATION=${CMAKE_TRY_COMPILE_CONFIGURATION}"
            "-DCMAKE_C_FLAGS=${CMAKE_C_FLAGS}" "-DCMAKE_TOOLCHAIN_FILE=${CMAKE_TOOLCHAIN_FILE}"
            "-DCMAKE_PREFIX_PATH=${CMAKE_PREFIX_PATH}" "-DSUNDIALS_DIR=${SUNDIALS_DIR}"
            "-DSUNDIALS_ROOT=${SUNDIALS_ROOT}"
        RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT status)
        execute_process(COMMAND "${CMAKE_COMMAND}" --build "${folder}"
            RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
    endif()
    set(why "no installed SUNDIALS with static cvode and nvecserial")
    if(output MATCHES "probe: ([^\n]*)")
        set(why "${CMAKE_MATCH_1}")
    endif()
    string(COMPARE EQUAL "${status}" 0 fit)
    set(CONTACT_SUNDIALS_FIT ${fit} CACHE INTERNAL "may the installed SUNDIALS go into an FMU?")
    set(CONTACT_SUNDIALS_REFUSED "${why}" CACHE INTERNAL "and if not, why")
endfunction()

# Upstream's sources as a part of this build: CVODE only, and nothing of it installed.
function(contact_build_sundials)
    include(FetchContent)
    FetchContent_Declare(sundials
        GIT_REPOSITORY https://github.com/LLNL/sundials.git
        GIT_TAG ${contact_sundials_commit}
        SOURCE_SUBDIR only-the-files) # no such folder: it is added below, out of `all` and `install`
    FetchContent_MakeAvailable(sundials)
    foreach(package ARKODE CVODES IDA IDAS KINSOL)
        set(BUILD_${package} OFF CACHE INTERNAL "")
    endforeach()
    foreach(off BUILD_SHARED_LIBS EXAMPLES_ENABLE_C EXAMPLES_INSTALL ENABLE_MPI ENABLE_OPENMP)
        set(${off} OFF CACHE INTERNAL "")
    endforeach()
    set(CMAKE_POSITION_INDEPENDENT_CODE ON)
    set(CMAKE_C_VISIBILITY_PRESET hidden)
    # Its messages name their source file; a path of the build machine has no place in an FMU.
    add_compile_options("-ffile-prefix-map=${sundials_SOURCE_DIR}/=sundials/"
        "-ffile-prefix-map=${sundials_BINARY_DIR}/=sundials/" -ffunction-sections -fdata-sections)
    # No fused multiplications, as in this project's own code (ContactWarnings.cmake): ARM has them, and clang uses them.
    add_compile_options(-ffp-contract=off)
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    add_subdirectory("${sundials_SOURCE_DIR}" "${sundials_BINARY_DIR}" EXCLUDE_FROM_ALL SYSTEM)
endfunction()

set(contact_use_installed OFF)
set(contact_use_bundled OFF)
if(CONTACT_SUNDIALS STREQUAL "auto" AND CMAKE_CROSSCOMPILING)
    message(STATUS "SUNDIALS: none is installed for another platform")
elseif(CONTACT_SUNDIALS STREQUAL "auto" AND EXISTS "${contact_bundled_sundials}")
    set(contact_use_bundled ON)
elseif(NOT CONTACT_SUNDIALS STREQUAL "fetch")
    contact_probe_installed_sundials()
    set(contact_use_installed ${CONTACT_SUNDIALS_FIT})
    if(NOT CONTACT_SUNDIALS_FIT AND CONTACT_SUNDIALS STREQUAL "system")
        message(FATAL_ERROR "CONTACT_SUNDIALS=system: ${CONTACT_SUNDIALS_REFUSED}")
    elseif(NOT CONTACT_SUNDIALS_FIT)
        message(STATUS "SUNDIALS: ${CONTACT_SUNDIALS_REFUSED}")
    endif()
endif()

if(contact_use_bundled)
    contact_use_bundled_sundials()
elseif(contact_use_installed)
    include("${PROJECT_SOURCE_DIR}/cmake/InstalledSundials.cmake")
    message(STATUS "SUNDIALS: ${SUNDIALS_VERSION}, installed at ${SUNDIALS_DIR}")
else()
    message(STATUS "SUNDIALS: building upstream's")
    contact_build_sundials()
    add_library(contact_sundials INTERFACE)
    target_link_libraries(contact_sundials INTERFACE SUNDIALS::cvode_static SUNDIALS::nvecserial_static)
    set(contact_sundials_headers "${sundials_SOURCE_DIR}/include" "${sundials_BINARY_DIR}/include")
endif()
add_library(contact::sundials ALIAS contact_sundials)
