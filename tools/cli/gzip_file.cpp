#include "tools/cli/gzip_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <limits>

#include "bridge/base/errno_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr unsigned kBuffer = 128 << 10;  // bytes; zlib.h asks for large ones

gzFile gzip(void* file) { return static_cast<gzFile>(file); }

}  // namespace

void GzipFile::Closer::operator()(void* file) const { ::gzclose(gzip(file)); }

GzipFile::GzipFile(std::string path)
    : path_(std::move(path)), file_(::gzopen(path_.c_str(), "wbxe")) {
  if (file_)
    ::gzbuffer(gzip(file_.get()), kBuffer);
  else
    fail();
}

GzipFile::~GzipFile() = default;

std::optional<std::string> GzipFile::close() {
  if (file_ && ::gzclose(gzip(file_.release())) != Z_OK) fail();
  return fault_;
}

GzipFile::int_type GzipFile::overflow(int_type character) {
  if (traits_type::eq_int_type(character, traits_type::eof()))
    return traits_type::not_eof(character);
  const char one = traits_type::to_char_type(character);
  return xsputn(&one, 1) == 1 ? character : traits_type::eof();
}

std::streamsize GzipFile::xsputn(const char* text, std::streamsize size) {
  if (!file_ || fault_) return 0;
  constexpr std::streamsize kMost = std::numeric_limits<int>::max();
  const auto part = static_cast<unsigned>(std::min(size, kMost));
  if (part == 0) return 0;
  if (::gzwrite(gzip(file_.get()), text, part) == static_cast<int>(part)) return part;
  fail();
  return 0;
}

void GzipFile::fail() {
  if (!fault_) fault_ = path_ + " cannot be written: " + errno_text(errno);
}

}  // namespace fieldcast::cli
