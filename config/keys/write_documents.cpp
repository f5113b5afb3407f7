// Writes fieldcast.schema.json and the tables of README.md into the given `config` directory. Run
// by `cmake --build build --target documents`.
#include <cstdio>
#include <fstream>
#include <sstream>

#include "config/keys/documents.hpp"

namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

bool replace(const std::string& path, const std::string& text) {
  if (text_of(path) == text) return true;
  std::ofstream out(path);
  out << text;
  return static_cast<bool>(out.flush());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: config_documents FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = argv[1];
  const std::string readme = folder + "/README.md";
  const bool written =
      replace(folder + "/fieldcast.schema.json", fieldcast::config::schema_text()) &&
      replace(readme, fieldcast::config::with_key_tables(text_of(readme)));
  if (!written) std::fprintf(stderr, "%s cannot be written\n", folder.c_str());
  return written ? 0 : 1;
}
