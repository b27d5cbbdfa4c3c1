# A room is a static library of everything below one folder. `goldthread_room(NAME SOURCES DIR LINK ...)`.
set(GOLDTHREAD_WARNINGS -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual
    -Wconversion -Wno-sign-conversion -Wdouble-promotion -Wimplicit-fallthrough -Werror
    # g++ 12 sees overlapping copies in std::string at -O3 where there are none (GCC bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)

# Contraction into fused multiply-adds would let results depend on how the compiler inlines; off, so that the
# same source gives the same bytes with every preset of one compiler.
set(GOLDTHREAD_CODEGEN -ffp-contract=off)

function(goldthread_room name)
  cmake_parse_arguments(ROOM "" "SOURCES" "LINK" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${ROOM_SOURCES}/*.cpp)
  if(NOT sources)  # a room of headers only
    add_library(goldthread_${name} INTERFACE)
    target_include_directories(goldthread_${name} INTERFACE ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/include)
    target_compile_definitions(goldthread_${name} INTERFACE GLM_ENABLE_EXPERIMENTAL GLM_FORCE_XYZW_ONLY)
    target_link_libraries(goldthread_${name} INTERFACE ${ROOM_LINK})
    return()
  endif()
  add_library(goldthread_${name} STATIC ${sources})
  target_include_directories(goldthread_${name} PUBLIC ${CMAKE_SOURCE_DIR}/src ${CMAKE_SOURCE_DIR}/include)
  target_compile_options(goldthread_${name} PRIVATE ${GOLDTHREAD_WARNINGS} ${GOLDTHREAD_CODEGEN})
  target_compile_definitions(goldthread_${name} PUBLIC GLM_ENABLE_EXPERIMENTAL GLM_FORCE_XYZW_ONLY)
  target_link_libraries(goldthread_${name} PUBLIC ${ROOM_LINK})
  if(NOT name STREQUAL "files" AND NOT name STREQUAL "session")
    target_precompile_headers(goldthread_${name} PRIVATE ${CMAKE_SOURCE_DIR}/src/base/precompiled.h)
  endif()
endfunction()
