# contact_compile_options(target): the language, the warnings and the floating point rules of this project's
# own code.
function(contact_compile_options target)
    set_target_properties(${target} PROPERTIES C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
    target_compile_options(${target} PRIVATE
        -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Wmissing-prototypes
        $<$<BOOL:${CONTACT_WARNINGS_AS_ERRORS}>:-Werror>
        # A compiler may fuse a*b+c into one rounding where the processor can, and each may choose other
        # places. Without fusing, all compilers and processors give the same digits, and a saved state goes on
        # with the same bits.
        -ffp-contract=off
        # CMake's Release says -O3, which makes the libraries 7 % larger.
        $<$<CONFIG:Release>:-O2>
        # No path of the build machine in messages or debug information.
        "-ffile-prefix-map=${PROJECT_SOURCE_DIR}=."
        "-ffile-prefix-map=${PROJECT_BINARY_DIR}=./build")
endfunction()
