// The files that a configuration names: channel lists and device templates. Each is read and parsed
// once, however many devices use it.
//
// Owns their documents for the length of one load; nodes given out point into them.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "config/document.hpp"
#include "config/fault_list.hpp"
#include "config/loader.hpp"

namespace fieldcast::config {

class Library {
 public:
  // Borrows all three. `used` is the size of the main file: all files together share
  // kMaxTotalBytes.
  Library(const FileReader& reader, const LoadOptions& options, FaultList& faults,
          std::size_t used);

  // The content as a tree, or nothing with the faults noted: at `naming` when there is no such
  // file, inside the file otherwise.
  const Node* channel_list(const Node& naming);
  const Node* device_template(const Node& naming);

  // The declaration of a protocol, without a fault when there is none.
  struct Found {
    bool exists = false;
    // Nothing: its text is broken, or it cannot be read; the faults are noted.
    const Node* root = nullptr;
  };
  Found protocol_declaration(const Node& naming);
  // The names of all that exist.
  std::vector<std::string> declared_protocols(const Node& naming) const;

  // For other files that are only named: a fault at `naming` when the file cannot be read. Returns
  // the path by which this process opens it.
  std::string check_file(const Node& naming);

 private:
  // `what` the file is named as.
  const Node* opened(const std::string& path, const Node& naming, std::string_view what);
  const Node* keep(const std::string& path, std::string text, std::string_view what);
  // A file NAME.yaml in the first of the directories that has it.
  Found in_directories(const Node& naming, std::string_view what,
                       std::span<const std::string> directories);
  std::vector<std::string> names_in(std::span<const std::string> directories,
                                    std::string_view suffix) const;
  void fault_missing(const Node& naming, const std::string& what, FileError error,
                     std::span<const std::string> directories, std::string_view suffix);
  tl::expected<std::string, FileError> read(const std::string& path);

  const FileReader& reader_;
  const LoadOptions& options_;
  FaultList& faults_;
  std::size_t used_;
  std::map<std::string, std::unique_ptr<Document>> documents_;
};

}  // namespace fieldcast::config
