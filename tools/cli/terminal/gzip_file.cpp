#include "tools/cli/terminal/gzip_file.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <limits>
#include <mutex>
#include <set>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::cli {
namespace {

constexpr unsigned kBuffer = 128 << 10;  // bytes; zlib.h recommends large buffers

gzFile gzip(void* file) { return static_cast<gzFile>(file); }

// Temporary files of this process, to be removed if a signal ends it.
std::mutex unfinished_mutex;
std::set<std::string> unfinished;

}  // namespace

void GzipFile::Closer::operator()(void* file) const { ::gzclose(gzip(file)); }

GzipFile::GzipFile(std::string path) : path_(std::move(path)) {
  open();
  if (descriptor_ < 0) {
    fail();
    return;
  }
  file_.reset(::gzdopen(::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0), "wb"));
  if (file_)
    ::gzbuffer(gzip(file_.get()), kBuffer);
  else
    fail();
}

GzipFile::~GzipFile() {
  file_.reset();
  if (descriptor_ >= 0) ::close(descriptor_);
  drop_temporary();
}

void GzipFile::take_temporary(std::string path) {
  const std::lock_guard lock(unfinished_mutex);
  temporary_ = std::move(path);
  unfinished.insert(temporary_);
}

void GzipFile::drop_temporary() {
  if (temporary_.empty()) return;
  const std::lock_guard lock(unfinished_mutex);
  ::unlink(temporary_.c_str());
  unfinished.erase(temporary_);
}

void GzipFile::remove_unfinished() noexcept {
  const std::lock_guard lock(unfinished_mutex);
  for (const std::string& path : unfinished) ::unlink(path.c_str());
}

void GzipFile::open() {
  constexpr mode_t kMode = 0666;
  if (::faccessat(AT_FDCWD, path_.c_str(), F_OK, AT_SYMLINK_NOFOLLOW) == 0) {
    errno = EEXIST;
    return;
  }
  const auto folder = std::filesystem::path(path_).parent_path();
  descriptor_ =
      ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
  if (descriptor_ >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return;
  const std::string part = path_ + ".part";
  descriptor_ = ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (descriptor_ >= 0) take_temporary(part);
}

// Fails if a file of this name was created meanwhile.
void GzipFile::give_name() {
  const std::string from =
      temporary_.empty() ? "/proc/self/fd/" + std::to_string(descriptor_) : temporary_;
  if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, path_.c_str(),
               temporary_.empty() ? AT_SYMLINK_FOLLOW : 0) != 0)
    fail();
}

std::optional<std::string> GzipFile::close() {
  if (file_ && ::gzclose(gzip(file_.release())) != Z_OK) fail();
  if (!fault_) give_name();
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
