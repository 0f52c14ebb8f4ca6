# Windows on x86-64, with the Universal C Runtime that Windows 10 and later bring
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(contact_zig_target x86_64-windows-gnu)
# CMake would link a dozen libraries of Windows, none of which an FMU needs.
set(CMAKE_C_STANDARD_LIBRARIES "" CACHE STRING "")
include("${CMAKE_CURRENT_LIST_DIR}/zig.cmake")
