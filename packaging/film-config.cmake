# find_package(film): the libraries of the stages as film::pipeline (files, scenes, photos, stress), film::findgrains,
# film::tracker, film::contacts, film::forces, film::simulation, film::calibration, film::report.
# Their public headers, at most 20, are those of packaging/public_headers.txt (CONTRIBUTING.md, "Public headers"): data
# and files by pipeline/, and one call of each stage that takes the scene instead of options: grains_in_photo(),
# track_photo(), contacts_in_photo(), forces_in_packing(). Everything else may change without notice.
# C and C++ must be enabled: film::findgrains holds the C++ of OpenCV.
include(CMakeFindDependencyMacro)
find_dependency(OpenMP COMPONENTS C)
find_dependency(TIFF)
find_dependency(OpenSSL COMPONENTS Crypto)
find_dependency(ZLIB)
find_dependency(PkgConfig)
pkg_check_modules(CJSON REQUIRED IMPORTED_TARGET libcjson)
pkg_check_modules(CAIRO REQUIRED IMPORTED_TARGET cairo fontconfig)
include(${CMAKE_CURRENT_LIST_DIR}/film-targets.cmake)
