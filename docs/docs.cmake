# The book: cmake --build build/release --target docs, then open build/release/docs/html/index.html.
# Debian packages: doxygen doxygen-awesome-css libjs-mathjax. Without them there is no target and nothing else changes.
find_package(Doxygen 1.9.4 QUIET)
find_package(Python3 3.11 QUIET COMPONENTS Interpreter)
find_path(DPDREF_DOXYGEN_THEME doxygen-awesome.css
          PATHS /usr/share /usr/local/share PATH_SUFFIXES doxygen-awesome-css)
find_path(DPDREF_MATHJAX jax/output/SVG/jax.js
          PATHS /usr/share /usr/local/share PATH_SUFFIXES javascript/mathjax)
mark_as_advanced(DPDREF_DOXYGEN_THEME DPDREF_MATHJAX)
if(NOT DOXYGEN_FOUND OR NOT Python3_FOUND OR NOT DPDREF_DOXYGEN_THEME OR NOT DPDREF_MATHJAX)
    message(STATUS "No target docs: it needs doxygen, doxygen-awesome-css and libjs-mathjax")
    return()
endif()

set(DPDREF_BOOK ${PROJECT_BINARY_DIR}/docs)
file(MAKE_DIRECTORY ${DPDREF_BOOK})

# The page's head: Doxygen's own, with the theme's switch for dark mode, which paper ignores, and the width of a phone.
execute_process(COMMAND ${DOXYGEN_EXECUTABLE} -w html header.html footer.html style.css
                WORKING_DIRECTORY ${DPDREF_BOOK} OUTPUT_QUIET ERROR_QUIET)
file(READ ${DPDREF_BOOK}/header.html DPDREF_HEADER)
if(NOT DPDREF_HEADER MATCHES "name=\"viewport\"")
    string(REPLACE "<head>" "<head>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
           DPDREF_HEADER "${DPDREF_HEADER}")
endif()
# No box that says what MathJax loads, and no error in place of a formula where a busy machine takes its time; the search is the book's own.
string(REPLACE "$mathjax" "<script type=\"text/x-mathjax-config\">MathJax.Ajax.timeout = 300000; MathJax.Hub.Config({messageStyle: 'none', displayAlign: 'left', displayIndent: '2em'})</script>\n$mathjax"
       DPDREF_HEADER "${DPDREF_HEADER}")
string(REPLACE "</head>" [[
<script type="text/javascript" src="$relpath^doxygen-awesome-darkmode-toggle.js"></script>
<script type="text/javascript" src="$relpath^doxygen-awesome-fragment-copy-button.js"></script>
<script type="text/javascript" src="$relpath^doxygen-awesome-paragraph-link.js"></script>
<script type="text/javascript" src="$relpath^reader.js"></script>
<script type="text/javascript">BookSearch.root = "$relpath^"</script>
</head>]] DPDREF_HEADER "${DPDREF_HEADER}")
string(REPLACE "<!--END TITLEAREA-->" [[
<div id="search-row"><span id="MSearchBox"><input id="search-field" type="search" autocomplete="off" spellcheck="false"
placeholder="Search: viscosity, Fig. 3b, eq. 12" aria-label="Search the book" aria-controls="search-results"/></span></div>
<ol id="search-results" hidden="hidden" aria-label="What the search found"></ol>
<!--END TITLEAREA-->]] DPDREF_HEADER "${DPDREF_HEADER}")
file(WRITE ${DPDREF_BOOK}/header.html "${DPDREF_HEADER}")

# From 1.9.5 on Doxygen has a dark mode of its own, which would fight with the theme's.
set(DPDREF_DOXYGEN_EXTRA "")
if(DOXYGEN_VERSION VERSION_GREATER_EQUAL 1.9.5)
    set(DPDREF_DOXYGEN_EXTRA "HTML_COLORSTYLE = LIGHT")
endif()
string(APPEND DPDREF_DOXYGEN_EXTRA "\nINPUT += \"${DPDREF_BOOK}/claims.md\"")
foreach(paper my1997 ng2007 pk2006)
    string(APPEND DPDREF_DOXYGEN_EXTRA "\nINPUT += \"${DPDREF_BOOK}/claims-${paper}.md\"")
endforeach()
file(GLOB DPDREF_FIGURES CONFIGURE_DEPENDS verification/*/figure.toml)
foreach(figure ${DPDREF_FIGURES})
    get_filename_component(figure ${figure} DIRECTORY)
    get_filename_component(figure ${figure} NAME)
    string(APPEND DPDREF_DOXYGEN_EXTRA "\nINPUT += \"${DPDREF_BOOK}/definition-${figure}.md\"")
endforeach()
configure_file(docs/Doxyfile.in ${DPDREF_BOOK}/Doxyfile @ONLY)

# What MathJax needs to set TeX as SVG, which has no fonts to load and so works from the file system in any browser.
set(DPDREF_COPY_MATHJAX "")
foreach(part extensions jax/element jax/input/TeX jax/output/SVG/autoload jax/output/SVG/fonts/TeX)
    list(APPEND DPDREF_COPY_MATHJAX
         COMMAND ${CMAKE_COMMAND} -E copy_directory ${DPDREF_MATHJAX}/${part} ${DPDREF_BOOK}/html/mathjax/${part})
endforeach()
foreach(part MathJax.js jax/output/SVG/jax.js jax/output/SVG/config.js)
    list(APPEND DPDREF_COPY_MATHJAX
         COMMAND ${CMAKE_COMMAND} -E copy ${DPDREF_MATHJAX}/${part} ${DPDREF_BOOK}/html/mathjax/${part})
endforeach()

# The live pages' scenes, and their engine where emscripten is.
set(DPDREF_LIVE_SCRIPTS COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/live/scripts.py ${DPDREF_BOOK}/html ${DPDREF_LIVE_ENGINE})

add_custom_target(docs
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${DPDREF_BOOK}/html
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/verification/tools/equations.py --write ${DPDREF_BOOK}
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/verification/tools/drawn_numbers.py
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/verification/tools/members.py
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/gallery.py ${DPDREF_BOOK}
    COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/verification/tools/claims.py --out ${DPDREF_BOOK}/claims.md
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/verification/tools/rooms.py --draw ${DPDREF_BOOK}/rooms.svg
    COMMAND ${DOXYGEN_EXECUTABLE} ${DPDREF_BOOK}/Doxyfile
    ${DPDREF_COPY_MATHJAX}
    ${DPDREF_LIVE_SCRIPTS}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/verification/tools/search_index.py ${DPDREF_BOOK}/html
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/verification/tools/links.py ${DPDREF_BOOK}/html
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "The book: ${DPDREF_BOOK}/html/index.html"
    VERBATIM)
if(TARGET live_engine)
    add_dependencies(docs live_engine)
endif()
