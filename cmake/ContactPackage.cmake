# What the wheel of the Python package carries beside scripts/contact_fmus, as the folder contact_fmus/share: this
# tree's sources, so that `contact-fmus build` needs only a C compiler, the shipped FMUs where a clone's build has
# them, and the archives of SUNDIALS. Only pyproject.toml asks for the component; `cmake --install` leaves it out.
set(component COMPONENT package EXCLUDE_FROM_ALL)

install(FILES CMakeLists.txt LICENSE DESTINATION . ${component})
install(DIRECTORY cmake fmu_src modelDescription DESTINATION . ${component} PATTERN "__pycache__" EXCLUDE)
install(DIRECTORY scripts/scenarios DESTINATION scripts ${component})

get_property(scenes GLOBAL PROPERTY CONTACT_SCENES)
list(TRANSFORM scenes REPLACE "(.+)" "${CONTACT_FMU_FOLDER}/\\1.fmu")
install(FILES ${scenes} DESTINATION build/fmus ${component})
install(TARGETS fmu_host lasting_contact RUNTIME DESTINATION build ${component})

foreach(part cvode nvecserial core) # core came with 7.0
    if(TARGET SUNDIALS::${part}_static)
        install(FILES $<TARGET_FILE:SUNDIALS::${part}_static> DESTINATION sundials/lib ${component})
    endif()
endforeach()
foreach(folder ${contact_sundials_headers})
    foreach(part cvode nvector sundials sunlinsol sunmatrix sunnonlinsol)
        if(EXISTS "${folder}/${part}")
            install(DIRECTORY "${folder}/${part}" DESTINATION sundials/include ${component}
                FILES_MATCHING PATTERN "*.h" PATTERN "priv" EXCLUDE)
        endif()
    endforeach()
endforeach()
install(FILES modelDescription/documentation/licenses/sundials.txt DESTINATION sundials ${component})
