# Of what is going to be packed, what Debian wants otherwise: compressed manuals and changelogs, zsh's
# completion elsewhere, and the licences of what the program holds. Run by CPack before it packs.

set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
file(GLOB below ${root}/*/usr)  # of components, in a folder more
if(below)
  get_filename_component(root ${below} DIRECTORY)
endif()
set(doc ${root}/usr/share/doc/clipgs)

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, if it is set
file(WRITE ${doc}/changelog.Debian "clipgs (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Version ${CPACK_PACKAGE_VERSION}; changelog.gz says what is new.

 -- ${CPACK_DEBIAN_PACKAGE_MAINTAINER}  ${date}
")
find_program(NODE node)
if(NODE AND EXISTS ${CPACK_CLIPGS_SOURCE}/web/node_modules)
  execute_process(COMMAND ${NODE} ${CPACK_CLIPGS_SOURCE}/packaging/licenses_of_others.mjs
                          ${CPACK_CLIPGS_SOURCE}/web ${doc}/LICENSES-OF-OTHERS
                  COMMAND_ERROR_IS_FATAL ANY)
endif()
file(RENAME ${root}/usr/share/zsh/site-functions ${root}/usr/share/zsh/vendor-completions)
file(GLOB manuals ${root}/usr/share/man/man1/*.1)
execute_process(COMMAND gzip -9nf ${manuals} ${doc}/changelog ${doc}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
