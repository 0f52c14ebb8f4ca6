# Target contact::fmi2_headers: fmi2Functions.h and what it includes.
#   1. the folder FMI2_HEADERS, when the user gives one;
#   2. the copy inside the Python package fmpy, found without importing it, which would take a second;
#   3. the FMI standard's repository at the commit of v2.0.5.
set(FMI2_HEADERS "" CACHE PATH "Folder of fmi2Functions.h; empty: looked for")

function(contact_find_fmi2_headers result)
    if(FMI2_HEADERS)
        if(NOT EXISTS "${FMI2_HEADERS}/fmi2Functions.h")
            message(FATAL_ERROR "FMI2_HEADERS=${FMI2_HEADERS} holds no fmi2Functions.h")
        endif()
        set(${result} "${FMI2_HEADERS}" PARENT_SCOPE)
        return()
    endif()
    execute_process(
        COMMAND "${Python3_EXECUTABLE}" -c
            "import importlib.util, os; print(os.path.dirname(importlib.util.find_spec('fmpy').origin))"
        OUTPUT_VARIABLE folder OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(folder AND EXISTS "${folder}/c-code/fmi2Functions.h")
        set(${result} "${folder}/c-code" PARENT_SCOPE)
        return()
    endif()
    message(STATUS "FMI 2.0 headers: no fmpy in ${Python3_EXECUTABLE}, fetching the standard's")
    include(FetchContent)
    FetchContent_Declare(fmi_standard
        GIT_REPOSITORY https://github.com/modelica/fmi-standard.git
        GIT_TAG 913d6b6908f6e6f59457bf299e875f17c818b921 # v2.0.5
        SOURCE_SUBDIR headers) # has no CMakeLists.txt: only the files are wanted
    FetchContent_MakeAvailable(fmi_standard)
    set(${result} "${fmi_standard_SOURCE_DIR}/headers" PARENT_SCOPE)
endfunction()

contact_find_fmi2_headers(contact_fmi2_folder)
message(STATUS "FMI 2.0 headers: ${contact_fmi2_folder}")
add_library(contact_fmi2_headers INTERFACE)
add_library(contact::fmi2_headers ALIAS contact_fmi2_headers)
target_include_directories(contact_fmi2_headers SYSTEM INTERFACE "${contact_fmi2_folder}")
