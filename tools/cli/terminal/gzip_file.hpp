// Writes a compressed file (RFC 1952), which has no name until it is complete: nothing remains if
// the process ends. Owns the file. Main thread.
#pragma once

#include <memory>
#include <optional>
#include <streambuf>
#include <string>

namespace fieldcast::cli {

class GzipFile final : public std::streambuf {
 public:
  // Never replaces a file. If it cannot be opened, close() returns the reason.
  explicit GzipFile(std::string path);
  ~GzipFile() override;
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  // Call once at the end. Returns a human-readable fault; empty on success.
  [[nodiscard]] std::optional<std::string> close();

  // Removes temporary files when a signal ends the process; any thread. They exist only on file
  // systems without O_TMPFILE.
  static void remove_unfinished() noexcept;

 protected:
  int_type overflow(int_type character) override;
  std::streamsize xsputn(const char* text, std::streamsize size) override;

 private:
  struct Closer {
    void operator()(void* file) const;
  };
  void fail();  // keeps the first reason
  void open();
  void give_name();
  void take_temporary(std::string path);
  void drop_temporary();

  const std::string path_;
  int descriptor_ = -1;                 // of the unnamed file
  std::string temporary_;               // temporary name on a file system without unnamed files
  std::unique_ptr<void, Closer> file_;  // gzFile; null: not open
  std::optional<std::string> fault_;
};

}  // namespace fieldcast::cli
