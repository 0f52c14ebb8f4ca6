# contact_sanitize(target): compiles and links with the sanitizers of CONTACT_SANITIZE (address,undefined).
# A program that was not built with it, such as Python, can load an FMU built with the address sanitizer when
# the sanitizer's library is loaded first; CONTACT_SANITIZER_PRELOAD is that library, and the tests use it.
set(CONTACT_SANITIZER_PRELOAD "")
if(CONTACT_SANITIZE MATCHES "address")
    if(NOT CMAKE_C_COMPILER_ID STREQUAL "GNU")
        message(FATAL_ERROR
            "CONTACT_SANITIZE=${CONTACT_SANITIZE} needs gcc: clang has no shared library to load first")
    endif()
    execute_process(COMMAND "${CMAKE_C_COMPILER}" -print-file-name=libasan.so
        OUTPUT_VARIABLE CONTACT_SANITIZER_PRELOAD OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()

function(contact_sanitize target)
    if(CONTACT_SANITIZE)
        set(flags "-fsanitize=${CONTACT_SANITIZE}" -fno-sanitize-recover=all -fno-omit-frame-pointer)
        target_compile_options(${target} PRIVATE ${flags})
        target_link_options(${target} PRIVATE ${flags})
    endif()
endfunction()
