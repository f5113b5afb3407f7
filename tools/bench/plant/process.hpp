// A child process of a bench: starts it, measures it and always stops it by its id.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace fieldcast::bench {

[[nodiscard]] bool has_program(const std::string& program);

class Process {
 public:
  // Starts `program` from this executable's directory. Throws std::runtime_error.
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::string& log_path);
  ~Process();  // calls stop()
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void stop();                               // SIGTERM, and SIGKILL after five seconds
  [[nodiscard]] double cpu_seconds() const;  // user and system
  [[nodiscard]] double resident_mb() const;
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
};

// 0 if the process has ended.
[[nodiscard]] double resident_mb(pid_t process);

// A temporary directory that is removed when this process ends, also by a signal.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
  int held_ = -1;       // open as long as this process lives
  pid_t remover_ = -1;  // removes the directory when held_ is closed
};

[[nodiscard]] bool wait_for_path(const std::string& path, double seconds);

[[nodiscard]] bool wait_for_text(const std::string& path, const std::string& text, double seconds);

// A probably unused DDS domain: 100..199 by the process id.
[[nodiscard]] unsigned own_domain();

}  // namespace fieldcast::bench
