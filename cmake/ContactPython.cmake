# The Python that runs the generator, the packaging and the tests: that of .venv when there is one
# (scripts/setup.sh makes it), else the one CMake finds. -DPython3_EXECUTABLE=... has the last word.
if(NOT Python3_EXECUTABLE AND EXISTS "${PROJECT_SOURCE_DIR}/.venv/bin/python")
    set(Python3_EXECUTABLE "${PROJECT_SOURCE_DIR}/.venv/bin/python"
        CACHE FILEPATH "The Python of generator and tests")
endif()
find_package(Python3 3.11 REQUIRED COMPONENTS Interpreter)

# tomllib came with Python 3.11, jinja2 has to be installed.
execute_process(
    COMMAND "${Python3_EXECUTABLE}" -c "import jinja2"
    RESULT_VARIABLE contact_python_result
    OUTPUT_QUIET ERROR_QUIET)
if(contact_python_result)
    message(FATAL_ERROR
        "The Python at ${Python3_EXECUTABLE} lacks jinja2, which the generator of the FMU sources needs.\n"
        "Run scripts/setup.sh, which makes .venv with everything, or install python3-jinja2, or name another "
        "Python with -DPython3_EXECUTABLE=...")
endif()
