# What the wheel of the Python package carries beside scripts/contact_fmus, as the folder contact_fmus/share: this
# tree's sources, so that `contact-fmus build` needs only a C compiler, the shipped FMUs where a clone's build has
# them, and the archives of SUNDIALS. Only pyproject.toml asks for the component; `cmake --install` leaves it out.
set(component COMPONENT package EXCLUDE_FROM_ALL)

install(FILES CMakeLists.txt LICENSE DESTINATION . ${component})
install(DIRECTORY cmake fmu_src modelDescription DESTINATION . ${component} PATTERN "__pycache__" EXCLUDE)
install(FILES docs/sweep.md DESTINATION docs ${component})
install(DIRECTORY scripts/scenarios scripts/studies DESTINATION scripts ${component})

set(built "${PROJECT_BINARY_DIR}")
if(CONTACT_PREBUILT)
    get_filename_component(built "${CONTACT_PREBUILT}" ABSOLUTE BASE_DIR "${PROJECT_SOURCE_DIR}")
endif()
file(GLOB shipped CONFIGURE_DEPENDS "modelDescription/scenes/*.toml")
list(TRANSFORM shipped REPLACE ".*/(.+)\\.toml" "${built}/fmus/\\1.fmu")
install(FILES ${shipped} DESTINATION build/fmus ${component})
if(CONTACT_FMI3)
    list(TRANSFORM shipped REPLACE "/fmus/" "/fmus-fmi3/")
    install(FILES ${shipped} DESTINATION build/fmus-fmi3 ${component})
endif()
install(PROGRAMS "${built}/fmu_host" "${built}/contact_batch.so" DESTINATION build ${component})

add_custom_target(package_archives ALL)
foreach(part cvode nvecserial core) # core came with 7.0
    if(TARGET SUNDIALS::${part}_static)
        add_dependencies(package_archives SUNDIALS::${part}_static)
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
