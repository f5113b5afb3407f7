// A file that is compressed while it is written (RFC 1952), for std::ostream. It has no name until
// it is whole: whatever ends the process before, nothing half written is left. Owns the file. One
// owner, the main thread.
#pragma once

#include <memory>
#include <optional>
#include <streambuf>
#include <string>

namespace fieldcast::cli {

class GzipFile final : public std::streambuf {
 public:
  // A new file: one that is there is left alone. What cannot be opened takes nothing, and close()
  // says why.
  explicit GzipFile(std::string path);
  ~GzipFile() override;
  GzipFile(const GzipFile&) = delete;
  GzipFile& operator=(const GzipFile&) = delete;

  // To be called once, at the end. What went wrong, for people; nothing: all is in the file.
  [[nodiscard]] std::optional<std::string> close();

  // For a process that ends from another thread, at a signal: takes away what has a name already.
  // Only a file system without files that have none needs it.
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
  int descriptor_ = -1;    // of the file, for its name
  std::string temporary_;  // its name meanwhile, on a file system without files that have none
  std::unique_ptr<void, Closer> file_;  // gzFile; null: it could not be opened, or it is closed
  std::optional<std::string> fault_;
};

}  // namespace fieldcast::cli
