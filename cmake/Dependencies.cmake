# Everything comes from the distribution's packages (tools/packages.txt); nothing is downloaded here.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(glm REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(assimp REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)

find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(PkgConfig REQUIRED)

# Embree 4 where there is one (Ubuntu 24.04), Embree 3 otherwise (Debian 12); visibility/ray_caster hides which.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()
add_library(goldthread_embree INTERFACE)
add_library(goldthread::embree ALIAS goldthread_embree)
target_link_libraries(goldthread_embree INTERFACE embree)
string(REGEX MATCH "^[0-9]+" embree_major "${embree_VERSION}")
target_compile_definitions(goldthread_embree INTERFACE GOLDTHREAD_EMBREE=${embree_major})

pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
add_library(goldthread::webp ALIAS PkgConfig::WEBP)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)  # its CMake file names parts that Debian packs apart
add_library(goldthread::openexr ALIAS PkgConfig::OPENEXR)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
add_library(goldthread::libzip ALIAS PkgConfig::LIBZIP)
pkg_check_modules(SQLITE3 REQUIRED IMPORTED_TARGET sqlite3)
add_library(goldthread::sqlite3 ALIAS PkgConfig::SQLITE3)

find_path(TINYGLTF_INCLUDE tiny_gltf.h REQUIRED)
find_library(TINYGLTF_LIBRARY tinygltf REQUIRED)
add_library(goldthread_tinygltf INTERFACE)
add_library(goldthread::tinygltf ALIAS goldthread_tinygltf)
target_include_directories(goldthread_tinygltf SYSTEM INTERFACE ${TINYGLTF_INCLUDE})
target_link_libraries(goldthread_tinygltf INTERFACE ${TINYGLTF_LIBRARY})

# Their config files predate imported targets or give several names.
if(NOT TARGET draco::draco)
  find_path(DRACO_INCLUDE draco/compression/decode.h REQUIRED)
  find_library(DRACO_LIBRARY draco REQUIRED)
  add_library(draco::draco UNKNOWN IMPORTED)
  set_target_properties(draco::draco PROPERTIES IMPORTED_LOCATION ${DRACO_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${DRACO_INCLUDE})
endif()
