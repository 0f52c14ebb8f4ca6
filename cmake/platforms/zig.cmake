# What the platforms of this folder share: zig's C compiler, which brings the C libraries of all of them along.
#   CONTACT_ZIG_PROGRAM (environment): zig itself, where it is not on the path
# Set before: contact_zig_target, in zig's words; CMAKE_SYSTEM_NAME and CMAKE_SYSTEM_PROCESSOR.
set(contact_zig_program "$ENV{CONTACT_ZIG_PROGRAM}")
if(NOT contact_zig_program)
    find_program(CONTACT_ZIG_ON_PATH zig REQUIRED)
    set(contact_zig_program "${CONTACT_ZIG_ON_PATH}")
endif()
set(CMAKE_C_COMPILER "${contact_zig_program}" cc)
set(CMAKE_C_COMPILER_TARGET "${contact_zig_target}")

# zig compiles a run-time library once for each kind of build: here one kind for CMake's trials and for FMUs alike.
# The linker leaves symbols out, since strip may not know the platform.
set(CMAKE_TRY_COMPILE_CONFIGURATION Release)
set(CMAKE_C_FLAGS_INIT "-O2")
foreach(kind EXE MODULE SHARED)
    set(CMAKE_${kind}_LINKER_FLAGS_INIT "-s")
endforeach()

# zig's own ar: that of this machine makes archives that the linker for macOS does not read.
set(CMAKE_C_ARCHIVE_CREATE "\"${contact_zig_program}\" ar qcsD <TARGET> <OBJECTS>")
set(CMAKE_C_ARCHIVE_APPEND "\"${contact_zig_program}\" ar qsD <TARGET> <OBJECTS>")
set(CMAKE_C_ARCHIVE_FINISH ":")

# Nothing of this machine goes into a library for another.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
