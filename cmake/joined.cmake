# Most of what the compiler does for a source is to read headers, so the many sources of a target are
# compiled in so many groups. The group follows from a source's name: a new one changes one group, not all.
# Sources of different chips stay apart: the same constants have other values there.
option(TMCL_JOIN_SOURCES "Compile several sources of a target at once" OFF)

function(tmcl_join_sources target groups)
  if(NOT TMCL_JOIN_SOURCES)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME)
    if(name MATCHES "tmc429|tmc4361|tmc457|sixpoint|mc1451a|stand_in")
      set(group ${CMAKE_MATCH_0})
    else()
      string(MD5 hash ${name})
      string(SUBSTRING ${hash} 0 4 hash)
      math(EXPR group "0x${hash} % ${groups}")
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP group_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # The compiler takes a joined source for a header, and warns of types in its unnamed namespace, and of local
  # names that another source has, too. The preset `dev` shows what is wrong in a source itself.
  target_compile_options(${target} PRIVATE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()
