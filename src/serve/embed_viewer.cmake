# Writes OUTPUT, a C++ file that holds every file below FOLDER (see viewer_bundle.h). FILE.br and FILE.gz are FILE
# compressed.
# Usage: cmake -DFOLDER=... -DOUTPUT=... -P embed_viewer.cmake
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(FILTER files EXCLUDE REGEX "\\.(br|gz)$")
list(SORT files)
set(data "")
set(table "")
set(number 0)

# embed(PATH RESULT): the bytes of a file as an expression, none if there is no such file.
function(embed path result)
  if(NOT EXISTS ${FOLDER}/${path})
    set(${result} "{}" PARENT_SCOPE)
    return()
  endif()
  string(APPEND data "__asm__(\".section .rodata\\n.balign 16\\n\"
        \"viewer_file_${number}:\\n.incbin \\\"${FOLDER}/${path}\\\"\\n\"
        \"viewer_file_${number}_end:\\n.previous\\n\");
extern \"C\" const char viewer_file_${number}[];
extern \"C\" const char viewer_file_${number}_end[];\n")
  set(${result} "piece(viewer_file_${number}, viewer_file_${number}_end)" PARENT_SCOPE)
  math(EXPR number "${number} + 1")
  set(number ${number} PARENT_SCOPE)
  set(data "${data}" PARENT_SCOPE)
endfunction()

foreach(path ${files})
  embed(${path} bytes)
  embed(${path}.br brotli)
  embed(${path}.gz gzip)
  file(SHA256 ${FOLDER}/${path} checksum)
  string(SUBSTRING ${checksum} 0 16 checksum)
  string(APPEND table "      {\"${path}\", \"${checksum}\", ${bytes}, ${brotli}, ${gzip}},\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"serve/viewer_bundle.h\"

${data}
namespace clipgs {

namespace {

std::string_view piece(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::span<const ViewerFile> viewer_files() {
  static const ViewerFile files[] = {
${table}  };
  return files;
}

}  // namespace clipgs
")
