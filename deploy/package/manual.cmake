# Man pages and bash completion, of what the programs say of their command lines.
set(manual ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual})
foreach(program IN LISTS binaries)
  add_custom_command(
    OUTPUT ${manual}/${program}.1.gz
    COMMAND ${program} --print-manual > ${manual}/${program}.1
    COMMAND gzip -9nf ${manual}/${program}.1
    DEPENDS ${program}
    COMMENT "man ${program}" VERBATIM)
  list(APPEND pages ${manual}/${program}.1.gz)
endforeach()

# bash looks for a file of the command's name.
set(completion ${PROJECT_BINARY_DIR}/completion)
file(MAKE_DIRECTORY ${completion})
list(TRANSFORM binaries REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE program_files)
set(script ${CMAKE_CURRENT_SOURCE_DIR}/package/completion)
add_custom_command(
  OUTPUT ${completion}/gyrotwin
  COMMAND ${script} ${program_files} > ${completion}/gyrotwin
  DEPENDS ${script} ${script}.bash ${binaries}
  COMMENT "completion" VERBATIM)
foreach(program IN LISTS binaries)
  if(NOT program STREQUAL gyrotwin)
    file(CREATE_LINK gyrotwin ${completion}/${program} SYMBOLIC)
  endif()
endforeach()

add_custom_target(manual ALL DEPENDS ${pages} ${completion}/gyrotwin)
install(FILES ${pages} DESTINATION share/man/man1 COMPONENT gyrotwin)
install(DIRECTORY ${completion}/ DESTINATION share/bash-completion/completions COMPONENT gyrotwin)
