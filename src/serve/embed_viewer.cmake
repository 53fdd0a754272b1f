# Writes OUTPUT, a C++ file that holds every file below FOLDER (see viewer_bundle.h).
# Usage: cmake -DFOLDER=... -DOUTPUT=... -P embed_viewer.cmake
file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
list(SORT files)
set(data "")
set(table "")
set(number 0)
foreach(path ${files})
  string(APPEND data "__asm__(\".section .rodata\\n.balign 16\\n\"
        \"viewer_file_${number}:\\n.incbin \\\"${FOLDER}/${path}\\\"\\n\"
        \"viewer_file_${number}_end:\\n.previous\\n\");
extern \"C\" const char viewer_file_${number}[];
extern \"C\" const char viewer_file_${number}_end[];\n")
  string(APPEND table "      {\"${path}\", piece(viewer_file_${number}, viewer_file_${number}_end)},\n")
  math(EXPR number "${number} + 1")
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
