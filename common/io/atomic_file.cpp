#include "common/io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

#include "common/io/write_all.hpp"

namespace eg::io {
namespace {

/// A file of this process beside `path`; gone again unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& path)
      : name_(path.string() + ".partial-" + std::to_string(::getpid())),
        descriptor_(::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {}
  ~TemporaryFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  bool write(std::string_view bytes) { return write_all(descriptor_, bytes); }

  bool flush() { return ::fsync(descriptor_) == 0; }

  bool rename_to(const std::filesystem::path& path) {
    renamed_ = ::rename(name_.c_str(), path.c_str()) == 0;
    return renamed_;
  }

 private:
  std::string name_;
  int descriptor_;
  bool renamed_ = false;
};

/// Makes the names in a folder outlive a loss of power.
bool flush_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool flushed = ::fsync(descriptor) == 0;
  ::close(descriptor);
  return flushed;
}

/// Lets a stream write into a TemporaryFile, in blocks.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(TemporaryFile& file) : file_(file) { setp(block_.data(), block_.data() + block_.size()); }

 protected:
  int_type overflow(int_type character) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(character, traits_type::eof())) sputc(traits_type::to_char_type(character));
    return traits_type::not_eof(character);
  }
  int sync() override {
    const bool written = file_.write({pbase(), static_cast<std::size_t>(pptr() - pbase())});
    setp(block_.data(), block_.data() + block_.size());
    return written ? 0 : -1;
  }

 private:
  TemporaryFile& file_;
  std::vector<char> block_ = std::vector<char>(1 << 16);
};

}  // namespace

base::Status check_writable(const std::filesystem::path& folder) {
  std::string name = (folder / ".egraph-probe-XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) return base::fail(folder.string() + ": cannot be written to: " + std::strerror(errno));
  ::close(descriptor);
  ::unlink(name.c_str());
  return {};
}

base::Status write_file_atomically(const std::filesystem::path& path, std::string_view bytes, Durability durability) {
  const auto failed = [&] { return base::fail(path.string() + ": cannot be written: " + std::strerror(errno)); };
  TemporaryFile file(path);
  if (!file.is_open()) return failed();
  const bool to_disk = durability == Durability::machine;
  if (!file.write(bytes) || (to_disk && !file.flush()) || !file.rename_to(path)) return failed();
  if (to_disk && !flush_folder(path.parent_path())) return failed();
  return {};
}

base::Status write_file_atomically(const std::filesystem::path& path,
                                   const std::function<base::Status(std::ostream&)>& write) {
  const auto failed = [&] { return base::fail(path.string() + ": cannot be written: " + std::strerror(errno)); };
  TemporaryFile file(path);
  if (!file.is_open()) return failed();
  FileBuffer buffer(file);
  std::ostream stream(&buffer);
  errno = 0;
  if (const base::Status written = write(stream); !written) {
    return errno == ENOSPC ? failed() : base::fail(path.string() + ": " + written.error().message);
  }
  if (!stream.flush() || !file.rename_to(path)) return failed();
  return {};
}

}  // namespace eg::io
