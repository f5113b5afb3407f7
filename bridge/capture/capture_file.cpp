#include "bridge/capture/capture_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "bridge/base/errno_text.hpp"

namespace fieldcast {
namespace {

CaptureFile::Fault fault_of(const std::string& path, int error) {
  return {error, path + ": " + errno_text(error)};
}

}  // namespace

tl::expected<CaptureFile, CaptureFile::Fault> CaptureFile::make(const std::string& path) {
  FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file.valid()) return tl::unexpected(fault_of(path, errno));
  return CaptureFile(path, std::move(file));
}

tl::expected<void, CaptureFile::Fault> CaptureFile::append(ByteView blocks) {
  std::size_t written = 0;
  while (written < blocks.size()) {
    const auto wrote = ::write(file_.get(), blocks.data() + written, blocks.size() - written);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      const int error = wrote < 0 ? errno : ENOSPC;
      const auto end = static_cast<off_t>(size_);
      (void)::ftruncate(file_.get(), end);
      (void)::lseek(file_.get(), end, SEEK_SET);
      return tl::unexpected(fault_of(path_, error));
    }
    written += static_cast<std::size_t>(wrote);
  }
  size_ += blocks.size();
  return {};
}

bool CaptureFile::removed() const {
  struct stat about {};
  return ::fstat(file_.get(), &about) == 0 && about.st_nlink == 0;
}

}  // namespace fieldcast
