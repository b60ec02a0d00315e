# The engine of the live pages, where emscripten is (Debian package emscripten): target live_engine, which makes live_engine.js and
# live_engine.wasm in BUILD/live; docs/live/scripts.py puts both into the book. They are built when something asks for them.
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

# All rooms that a running scene stands on, without the plain engine and what keeps files of results, in a few units: headers take most of
# the compiler's time. So no two files of a unit may have a name in common, and registry.cpp, which has a `quoted` of its own, stands alone,
# away from <iomanip>. What takes time when it runs is compiled for speed, the rest for size; of what several units have the linker takes
# the first.
set(DPDREF_LIVE_fast engine engine/fast measure)
set(DPDREF_LIVE_small base model scene run live)
foreach(unit fast small)
    foreach(room ${DPDREF_LIVE_${unit}})
        file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${room}/*.cpp)
        list(APPEND DPDREF_LIVE_${unit}_sources ${found})
    endforeach()
endforeach()
file(GLOB DPDREF_LIVE_theory_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/theory/*.cpp)
set(DPDREF_LIVE_registry_sources ${PROJECT_SOURCE_DIR}/theory/registry.cpp)
list(REMOVE_ITEM DPDREF_LIVE_theory_sources ${DPDREF_LIVE_registry_sources})
list(APPEND DPDREF_LIVE_small_sources ${PROJECT_SOURCE_DIR}/docs/live/left_out.cpp)
foreach(room ${DPDREF_LIVE_fast} ${DPDREF_LIVE_small} plain)
    list(APPEND DPDREF_LIVE_OPTIONS -I${PROJECT_SOURCE_DIR}/src/${room})
endforeach()

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
foreach(unit fast theory registry small)
    set(sources ${DPDREF_LIVE_${unit}_sources})
    list(FILTER sources EXCLUDE REGEX
         "/(archive|configuration|hdf5|trajectory|signals|progress|codes|conventions|integrators|plain_stages|checkpoint|run|until|tune)[.]cpp$")
    list(TRANSFORM sources REPLACE "(.+)" "#include \"\\1\"\n")
    list(JOIN sources "" text)
    set(source ${DPDREF_LIVE}/${unit}.cpp)
    file(CONFIGURE OUTPUT ${source} CONTENT "${text}" @ONLY)
    set(for_size "")
    if(unit STREQUAL "small")
        set(for_size -Os)
    endif()
    add_custom_command(OUTPUT ${source}.o
        COMMAND ${DPDREF_LIVE_COMPILE} ${DPDREF_LIVE_OPTIONS} ${for_size} -MD -MF ${source}.d -c ${source} -o ${source}.o
        DEPENDS ${source} ${PROJECT_SOURCE_DIR}/docs/live/emscripten.h DEPFILE ${source}.d
        COMMENT "WebAssembly: ${unit}" VERBATIM)
    list(APPEND objects ${source}.o)
endforeach()

set(DPDREF_LIVE_ENGINE ${DPDREF_LIVE}/live_engine.js)
set(exports _malloc _free)
file(STRINGS ${PROJECT_SOURCE_DIR}/src/live/interface.cpp lines REGEX "^(int|void|char const\\*|double const\\*) live_[a-z_]+\\(")
foreach(line ${lines})
    string(REGEX MATCH "live_[a-z_]+" name "${line}")
    list(APPEND exports _${name})
endforeach()
list(JOIN exports "," exports)
add_custom_command(OUTPUT ${DPDREF_LIVE_ENGINE} ${DPDREF_LIVE}/live_engine.wasm
    COMMAND ${DPDREF_LIVE_COMPILE} ${objects} -o ${DPDREF_LIVE_ENGINE} -sMODULARIZE -sEXPORT_NAME=DpdrefEngine
            -sALLOW_MEMORY_GROWTH -sENVIRONMENT=web,worker,node -sEXPORTED_FUNCTIONS=${exports} -sEXPORTED_RUNTIME_METHODS=cwrap --no-entry
    DEPENDS ${objects} COMMENT "The live pages' engine" VERBATIM)
add_custom_target(live_engine DEPENDS ${DPDREF_LIVE_ENGINE})
