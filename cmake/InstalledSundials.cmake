# Target contact_sundials of an installed SUNDIALS, 6.4 or newer; included by ContactSundials.cmake and, to
# try it out first, by sundials_probe.

# Debian's SUNDIALS asks for OpenMP, which only its OpenMP vectors need; clang without libomp has none, and
# the whole package would count as missing. It does not ask when the target is there.
if(NOT TARGET OpenMP::OpenMP_C)
    add_library(OpenMP::OpenMP_C INTERFACE IMPORTED)
endif()
find_package(SUNDIALS 6.4 CONFIG REQUIRED COMPONENTS cvode nvecserial)

# The archives by file: the static targets of 7.x drag in libsundials_core.so where both kinds are installed,
# and so does sunlinsoldense_static of 6.x. cvode_static holds its dense solver and matrix.
add_library(contact_sundials INTERFACE)
foreach(part cvode nvecserial core) # core came with 7.0
    if(TARGET SUNDIALS::${part}_static)
        target_link_libraries(contact_sundials INTERFACE $<TARGET_FILE:SUNDIALS::${part}_static>)
    endif()
endforeach()
target_link_libraries(contact_sundials INTERFACE m)
get_target_property(contact_sundials_headers SUNDIALS::cvode_static INTERFACE_INCLUDE_DIRECTORIES)
target_include_directories(contact_sundials SYSTEM INTERFACE ${contact_sundials_headers})
target_compile_definitions(contact_sundials INTERFACE SUNDIALS_STATIC_DEFINE)
