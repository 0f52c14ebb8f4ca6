# Targets contact::fmi2_headers and contact::fmi3_headers: fmi2Functions.h, fmi3Functions.h and what they include.
#   1. the folders FMI2_HEADERS and FMI3_HEADERS, when the user gives them;
#   2. the copies inside the Python package fmpy, found without importing it, which would take a second;
#   3. the FMI standard's repository at the commits of v2.0.5 and v3.0.2.
set(FMI2_HEADERS "" CACHE PATH "Folder of fmi2Functions.h; empty: looked for")
set(FMI3_HEADERS "" CACHE PATH "Folder of fmi3Functions.h; empty: looked for")

# contact_find_fmi_headers(2|3 commit result)
function(contact_find_fmi_headers version commit result)
    set(given "${FMI${version}_HEADERS}")
    set(header "fmi${version}Functions.h")
    if(given)
        if(NOT EXISTS "${given}/${header}")
            message(FATAL_ERROR "FMI${version}_HEADERS=${given} holds no ${header}")
        endif()
        set(${result} "${given}" PARENT_SCOPE)
        return()
    endif()
    execute_process(
        COMMAND "${Python3_EXECUTABLE}" -c
            "import importlib.util, os; print(os.path.dirname(importlib.util.find_spec('fmpy').origin))"
        OUTPUT_VARIABLE folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(folder AND EXISTS "${folder}/c-code/${header}")
        set(${result} "${folder}/c-code" PARENT_SCOPE)
        return()
    endif()
    message(STATUS "FMI ${version}.0 headers: no fmpy in ${Python3_EXECUTABLE}, fetching the standard's")
    include(FetchContent)
    FetchContent_Declare(fmi${version}_standard
        GIT_REPOSITORY https://github.com/modelica/fmi-standard.git
        GIT_TAG ${commit}
        SOURCE_SUBDIR headers) # has no CMakeLists.txt: only the files are wanted
    FetchContent_MakeAvailable(fmi${version}_standard)
    set(${result} "${fmi${version}_standard_SOURCE_DIR}/headers" PARENT_SCOPE)
endfunction()

# contact_fmi_headers(2|3 commit)
function(contact_fmi_headers version commit)
    contact_find_fmi_headers(${version} ${commit} folder)
    message(STATUS "FMI ${version}.0 headers: ${folder}")
    add_library(contact_fmi${version}_headers INTERFACE)
    add_library(contact::fmi${version}_headers ALIAS contact_fmi${version}_headers)
    target_include_directories(contact_fmi${version}_headers SYSTEM INTERFACE "${folder}")
endfunction()

contact_fmi_headers(2 913d6b6908f6e6f59457bf299e875f17c818b921) # v2.0.5
if(CONTACT_FMI3)
    contact_fmi_headers(3 b8778deaf5b746ba4a2f6c155d53f8a33eebbd33) # v3.0.2
endif()
