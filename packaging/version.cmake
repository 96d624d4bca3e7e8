# Writes OUTPUT, the C source of the version that files and --version name: VERSION, and where git knows it the commit
# that was built ("*" behind it: with changes). Run at every build; touched only when it changes.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=7 HEAD OUTPUT_VARIABLE commit RESULT_VARIABLE unknown
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
set(text ${VERSION})
if(NOT unknown)
  execute_process(COMMAND git -C ${SOURCE} diff-index --quiet HEAD -- . ":!tests" ":!docs" RESULT_VARIABLE changed ERROR_QUIET)
  string(APPEND text "+${commit}")
  if(changed)
    string(APPEND text "*")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT
  "#include \"pipeline/speak/version.h\"\n\nconst char film_version[] = \"@text@\";\n" @ONLY)
