#include "common/io/image_list.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <span>
#include <string>

#include "common/io/text_file.hpp"
#include "common/io/time_stamp.hpp"

namespace eg::io {
namespace {

/// An entry as written, before it is known whether the file counts seconds or images.
struct Entry {
  int line = 0;
  TimeStamp stamp;
  std::string_view stamp_text;
  std::string_view file_name;
};

/// A list must not lead a reader to files that are no part of the recording.
bool leaves_folder(const std::filesystem::path& path) {
  return path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end();
}

base::Result<Entry> parse_entry(const std::filesystem::path& list, int line, std::string_view stamp_text,
                                std::string_view file_name) {
  const auto stamp = parse_time_stamp(stamp_text);
  if (!stamp) return base::fail(located(list, line, in_quotes(stamp_text) + " is not a time stamp in seconds"));
  if (leaves_folder(file_name)) {
    return base::fail(located(list, line, "image path " + in_quotes(file_name) + " leaves the data set's folder"));
  }
  return Entry{line, *stamp, stamp_text, file_name};
}

bool counts_images(std::span<const Entry> entries) {
  return std::all_of(entries.begin(), entries.end(), [](const Entry& entry) { return entry.stamp.maybe_index; });
}

std::vector<ListedImage> to_images(const std::filesystem::path& list, std::span<const Entry> entries,
                                   double index_rate) {
  const double seconds_per_unit = counts_images(entries) ? 1.0 / index_rate : 1.0;
  std::vector<ListedImage> images;
  for (const Entry& entry : entries) {
    const double time_s = entry.stamp.value * seconds_per_unit;
    images.push_back({time_s, to_utime(time_s), list.parent_path() / entry.file_name});
  }
  return images;
}

base::Status check_increasing(const std::filesystem::path& list, std::span<const Entry> entries,
                              std::span<const ListedImage> images) {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (images[i].utime > images[i - 1].utime) continue;
    const std::string stamp = "time stamp " + std::string(entries[i].stamp_text);
    const std::string before = "line " + std::to_string(entries[i - 1].line);
    const std::string what = images[i].utime == images[i - 1].utime
                                 ? stamp + " repeats that of " + before
                                 : stamp + " is earlier than that of " + before + "; they must increase";
    return base::fail(located(list, entries[i].line, what));
  }
  return {};
}

bool names_depth(std::string_view file_name) {
  std::string lower(file_name);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.find("depth") != std::string::npos;
}

tl::unexpected<base::Error> unparsable(const std::filesystem::path& list, const TextLine& line,
                                       std::string_view wanted) {
  return base::fail(
      located(list, line.number, "expected '" + std::string(wanted) + "', found " + in_quotes(line.text)));
}

tl::unexpected<base::Error> no_images(const std::filesystem::path& list) {
  return base::fail(list.string() + ": names no images");
}

}  // namespace

base::Result<std::vector<ListedImage>> read_image_list(const std::filesystem::path& list, double index_rate) {
  const auto text = read_file(list);
  if (!text) return tl::make_unexpected(text.error());
  std::vector<Entry> entries;
  for (const TextLine& line : content_lines(*text)) {
    const auto fields = split_fields(line.text);
    if (fields.size() != 2) return unparsable(list, line, "timestamp filename");
    const auto entry = parse_entry(list, line.number, fields[0], fields[1]);
    if (!entry) return tl::make_unexpected(entry.error());
    entries.push_back(*entry);
  }
  if (entries.empty()) return no_images(list);
  std::vector<ListedImage> images = to_images(list, entries, index_rate);
  if (const auto status = check_increasing(list, entries, images); !status) return tl::make_unexpected(status.error());
  return images;
}

base::Result<std::vector<ListedPair>> read_association_list(const std::filesystem::path& list, double index_rate) {
  const auto text = read_file(list);
  if (!text) return tl::make_unexpected(text.error());
  std::vector<Entry> colour, depth;
  for (const TextLine& line : content_lines(*text)) {
    const auto fields = split_fields(line.text);
    if (fields.size() != 4) return unparsable(list, line, "timestamp filename timestamp filename");
    const bool depth_first = names_depth(fields[1]);
    if (depth_first == names_depth(fields[3])) {
      return base::fail(located(list, line.number, "exactly one of the two file names must contain 'depth'"));
    }
    const auto first = parse_entry(list, line.number, fields[0], fields[1]);
    const auto second = parse_entry(list, line.number, fields[2], fields[3]);
    if (!first) return tl::make_unexpected(first.error());
    if (!second) return tl::make_unexpected(second.error());
    colour.push_back(depth_first ? *second : *first);
    depth.push_back(depth_first ? *first : *second);
  }
  if (colour.empty()) return no_images(list);
  const std::vector<ListedImage> colour_images = to_images(list, colour, index_rate);
  const std::vector<ListedImage> depth_images = to_images(list, depth, index_rate);
  if (const auto status = check_increasing(list, colour, colour_images); !status) {
    return tl::make_unexpected(status.error());
  }
  std::vector<ListedPair> pairs;
  for (std::size_t i = 0; i < colour.size(); ++i) pairs.push_back({colour_images[i], depth_images[i]});
  return pairs;
}

}  // namespace eg::io
