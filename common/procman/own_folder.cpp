#include "common/procman/own_folder.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace eg::procman {

void put_own_folder_on_path() {
  std::error_code failure;
  const auto executable = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (failure) return;
  std::string path = executable.parent_path().string();
  if (const char* rest = std::getenv("PATH")) path.append(":").append(rest);
  setenv("PATH", path.c_str(), 1);
}

}  // namespace eg::procman
