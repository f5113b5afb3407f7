// The files named by a configuration; owns their documents during one load.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "config/document/document.hpp"
#include "config/files/file_reader.hpp"

namespace fieldcast::config {

class Library {
 public:
  // Borrows all three. `used`: size of the main file, part of kMaxTotalBytes.
  Library(const FileReader& reader, const LoadOptions& options, FaultList& faults,
          std::size_t used);

  // Null after faults, at `naming` if the file is missing, otherwise within the file.
  const Node* channel_list(const Node& naming);
  const Node* device_template(const Node& naming);

  // No fault if it is missing.
  struct Found {
    bool exists = false;
    // Null after faults: its text is invalid, or it cannot be read.
    const Node* root = nullptr;
  };
  Found protocol_declaration(const Node& naming);
  std::vector<std::string> declared_protocols(const Node& naming) const;

  // Adds a fault at `naming` if the file cannot be read. Returns the path to open.
  std::string check_file(const Node& naming);

 private:
  // `what`: the kind of the file.
  const Node* opened(const std::string& path, const Node& naming, std::string_view what);
  const Node* keep(const std::string& path, std::string text, std::string_view what);
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
