// A child process of a bench: started, measured, and ended by its id whatever happens.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace fieldcast::bench {

// Whether the folder in which this executable lies has such a program.
[[nodiscard]] bool has_program(const std::string& program);

class Process {
 public:
  // Starts `program` of the folder in which this executable lies; its output goes to log_path.
  // Throws std::runtime_error.
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::string& log_path);
  ~Process();  // stop()
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void stop();                               // SIGTERM, and SIGKILL after five seconds
  [[nodiscard]] double cpu_seconds() const;  // user and system
  [[nodiscard]] double resident_mb() const;
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
};

// What a process holds in memory; 0 if it is gone.
[[nodiscard]] double resident_mb(pid_t process);

// A folder of its own below the system's temporary one, removed when this process ends, also by a
// signal.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }
  // Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
  int held_ = -1;       // open as long as this process lives
  pid_t remover_ = -1;  // removes the folder when it is closed
};

// Waits until the path exists; false after the time is over.
[[nodiscard]] bool wait_for_path(const std::string& path, double seconds);

// Waits until the file holds the text; false after the time is over.
[[nodiscard]] bool wait_for_text(const std::string& path, const std::string& text, double seconds);

// A DDS domain that no other run of this machine is likely to use: 100..199 by the process id.
[[nodiscard]] unsigned own_domain();

}  // namespace fieldcast::bench
