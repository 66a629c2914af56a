# To include after find_package(OpenCASCADE): drops what only its viewer links against.
#
# The exported targets name X11, GL, fontconfig, FreeImage, FreeType and TBB for the linker, and
# Debian's packages do not bring all of them. Only the shared libraries themselves use them, and
# those find them at run time.
foreach(_toolkit IN LISTS OpenCASCADE_LIBRARIES)
  if(TARGET ${_toolkit})
    get_target_property(_used ${_toolkit} INTERFACE_LINK_LIBRARIES)
    list(FILTER _used INCLUDE REGEX "^TK")
    set_property(TARGET ${_toolkit} PROPERTY INTERFACE_LINK_LIBRARIES "${_used}")
  endif()
endforeach()
unset(_toolkit)
unset(_used)
