# The engine of the live pages: target live_engine, BUILD/live/live_engine.js, where emscripten is (Debian package emscripten).
# One file that holds the WebAssembly, too, so that it works from the file system. It is built when something asks for it.
find_program(DPDREF_EMCC emcc)
find_program(DPDREF_NODE NAMES node nodejs)
mark_as_advanced(DPDREF_EMCC DPDREF_NODE)
if(NOT DPDREF_EMCC OR NOT DPDREF_NODE OR NOT CMAKE_GENERATOR MATCHES "Ninja|Makefiles")
    message(STATUS "The live pages stand still: their engine needs emscripten")
    return()
endif()

set(DPDREF_LIVE ${PROJECT_BINARY_DIR}/live)
file(MAKE_DIRECTORY ${DPDREF_LIVE}/include)
# Headers alone, one folder each: with all of /usr/include the compiler would take this machine's C library for its own.
foreach(header Eigen/Core boost/version.hpp fmt/core.h toml++/toml.h hwy/highway.h nlohmann/json.hpp Random123/philox.h)
    get_filename_component(folder ${header} DIRECTORY)
    find_path(DPDREF_LIVE_${folder} ${header} PATH_SUFFIXES eigen3 NO_CACHE REQUIRED)
    file(CREATE_LINK ${DPDREF_LIVE_${folder}}/${folder} ${DPDREF_LIVE}/include/${folder} SYMBOLIC)
endforeach()

# Eigen asks for the registers of MMX, too, and uses none.
if(NOT EXISTS ${DPDREF_LIVE}/include/mmintrin.h)
    file(WRITE ${DPDREF_LIVE}/include/mmintrin.h "")
endif()

# All rooms that a running scene stands on, without what keeps files of results.
foreach(room base model plain engine engine/fast measure scene run live)
    file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${room}/*.cpp)
    list(APPEND DPDREF_LIVE_SOURCES ${sources})
    list(APPEND DPDREF_LIVE_OPTIONS -I${PROJECT_SOURCE_DIR}/src/${room})
endforeach()
file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/theory/*.cpp)
list(APPEND DPDREF_LIVE_SOURCES ${sources})
list(APPEND DPDREF_LIVE_SOURCES ${PROJECT_SOURCE_DIR}/docs/live/no_files.cpp)
list(FILTER DPDREF_LIVE_SOURCES EXCLUDE REGEX "/(archive|configuration|hdf5|trajectory|signals|codes|conventions|integrators|checkpoint|run|tune)[.]cpp$")

# SSE2, which emscripten translates: so Eigen sums in the order of the native program, and bits are the same;
# it would write assembler for compilers of another age than this one says it has.
# Special functions in double precision: long double is software there, fifty times slower, and no result needs it.
# Vectors of doubles as plain loops, which the compiler turns into WebAssembly's: Highway has none of its own there.
set(DPDREF_LIVE_COMPILE ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs ${DPDREF_EMCC}
    -O2 -msimd128 -msse2 -fgnuc-version=5.90 -fwasm-exceptions)
list(APPEND DPDREF_LIVE_OPTIONS -std=c++20 -ffp-contract=off -fno-math-errno -fno-trapping-math -Wno-c++11-narrowing
    -DFMT_HEADER_ONLY -DBOOST_MATH_PROMOTE_DOUBLE_POLICY=false -DHWY_COMPILE_ONLY_EMU128 -DDPDREF_PLAIN_TEXT="" -include ${PROJECT_SOURCE_DIR}/docs/live/emscripten.h
    -I${DPDREF_LIVE}/include -I${PROJECT_BINARY_DIR}/generated -I${PROJECT_SOURCE_DIR})
set(objects "")
foreach(source ${DPDREF_LIVE_SOURCES})
    file(RELATIVE_PATH object ${PROJECT_SOURCE_DIR} ${source})
    string(REPLACE "/" "_" object ${object})
    set(object ${DPDREF_LIVE}/${object}.o)
    add_custom_command(OUTPUT ${object}
        COMMAND ${DPDREF_LIVE_COMPILE} ${DPDREF_LIVE_OPTIONS} -MD -MF ${object}.d -c ${source} -o ${object}
        DEPENDS ${source} ${PROJECT_SOURCE_DIR}/docs/live/emscripten.h DEPFILE ${object}.d
        COMMENT "WebAssembly: ${source}" VERBATIM)
    list(APPEND objects ${object})
endforeach()

set(DPDREF_LIVE_ENGINE ${DPDREF_LIVE}/live_engine.js)
set(exports _malloc _free)
file(STRINGS ${PROJECT_SOURCE_DIR}/src/live/interface.cpp lines REGEX "^(int|void|char const\\*|double const\\*) live_[a-z_]+\\(")
foreach(line ${lines})
    string(REGEX MATCH "live_[a-z_]+" name "${line}")
    list(APPEND exports _${name})
endforeach()
list(JOIN exports "," exports)
add_custom_command(OUTPUT ${DPDREF_LIVE_ENGINE}
    COMMAND ${DPDREF_LIVE_COMPILE} ${objects} -o ${DPDREF_LIVE_ENGINE} -sSINGLE_FILE -sMODULARIZE -sEXPORT_NAME=DpdrefEngine
            -sALLOW_MEMORY_GROWTH -sENVIRONMENT=web,worker,node -sEXPORTED_FUNCTIONS=${exports} -sEXPORTED_RUNTIME_METHODS=cwrap --no-entry
    DEPENDS ${objects} COMMENT "The live pages' engine" VERBATIM)
add_custom_target(live_engine DEPENDS ${DPDREF_LIVE_ENGINE})
