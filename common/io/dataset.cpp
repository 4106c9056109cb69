#include "common/io/dataset.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "common/io/association.hpp"
#include "common/io/image_list.hpp"
#include "common/io/text_file.hpp"
#include "common/io/time_stamp.hpp"

namespace eg::io {
namespace {

namespace fs = std::filesystem;

constexpr std::array kAssociationFiles = {"associations.txt", "associate.txt", "association.txt"};

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::vector<std::int64_t> utimes_of(const std::vector<ListedImage>& images) {
  std::vector<std::int64_t> utimes;
  for (const ListedImage& image : images) utimes.push_back(image.utime);
  return utimes;
}

base::Status read_lists(Dataset& dataset, const DatasetOptions& options) {
  const fs::path colour_list = dataset.folder / "rgb.txt";
  const fs::path depth_list = dataset.folder / "depth.txt";
  if (!is_file(colour_list)) return base::fail(colour_list.string() + ": no such file, though depth.txt is there");
  if (!is_file(depth_list)) return base::fail(depth_list.string() + ": no such file, though rgb.txt is there");
  const auto colour = read_image_list(colour_list, options.index_rate);
  if (!colour) return tl::make_unexpected(colour.error());
  const auto depth = read_image_list(depth_list, options.index_rate);
  if (!depth) return tl::make_unexpected(depth.error());

  const auto pairs = associate(utimes_of(*colour), utimes_of(*depth), to_utime(options.max_time_difference_s));
  if (pairs.empty()) {
    return base::fail(dataset.folder.string() + ": no image of rgb.txt is within " +
                      std::to_string(to_utime(options.max_time_difference_s) / 1000) + " ms of one of depth.txt");
  }
  for (const auto& [c, d] : pairs) {
    dataset.frames.push_back({(*colour)[c].time_s, (*colour)[c].utime, (*colour)[c].path, (*depth)[d].path});
  }
  dataset.unpaired_colour = static_cast<std::int64_t>(colour->size() - pairs.size());
  dataset.unpaired_depth = static_cast<std::int64_t>(depth->size() - pairs.size());
  return {};
}

base::Status read_associations(Dataset& dataset, const fs::path& list, const DatasetOptions& options) {
  const auto pairs = read_association_list(list, options.index_rate);
  if (!pairs) return tl::make_unexpected(pairs.error());
  for (const auto& [colour, depth] : *pairs) {
    dataset.frames.push_back({colour.time_s, colour.utime, colour.path, depth.path});
  }
  return {};
}

/// Images named by their number, e.g. 17.png, in numeric order. Other files are not images of the recording.
base::Result<std::map<long long, fs::path>> numbered_images(const fs::path& folder) {
  std::map<long long, fs::path> images;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path extension = it->path().extension();
    if (extension != ".png" && extension != ".jpg" && extension != ".jpeg") continue;
    const std::string stem = it->path().stem().string();
    const auto stamp = parse_time_stamp(stem);
    if (!stamp || !stamp->maybe_index) continue;
    const auto number = static_cast<long long>(stamp->value);
    if (!images.emplace(number, it->path()).second) {
      return base::fail(folder.string() + ": holds two images with the number " + std::to_string(number));
    }
  }
  if (error) return base::fail(folder.string() + ": cannot be read: " + error.message());
  return images;
}

base::Status read_numbered(Dataset& dataset, const DatasetOptions& options) {
  const auto colour = numbered_images(dataset.folder / "rgb");
  if (!colour) return tl::make_unexpected(colour.error());
  const auto depth = numbered_images(dataset.folder / "depth");
  if (!depth) return tl::make_unexpected(depth.error());
  for (const auto& [number, path] : *colour) {
    const auto partner = depth->find(number);
    if (partner == depth->end()) continue;
    const double time_s = static_cast<double>(number) / options.index_rate;
    dataset.frames.push_back({time_s, to_utime(time_s), path, partner->second});
  }
  if (dataset.frames.empty()) {
    return base::fail(dataset.folder.string() + ": holds neither rgb.txt and depth.txt nor associations.txt, and no " +
                      "numbered image is in both rgb/ and depth/");
  }
  dataset.unpaired_colour = static_cast<std::int64_t>(colour->size() - dataset.frames.size());
  dataset.unpaired_depth = static_cast<std::int64_t>(depth->size() - dataset.frames.size());
  return {};
}

/// groundtruth.txt, else the first *.gt.freiburg by name, else nothing.
fs::path find_ground_truth(const fs::path& folder) {
  if (is_file(folder / "groundtruth.txt")) return folder / "groundtruth.txt";
  fs::path first;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().ends_with(".gt.freiburg") && (first.empty() || it->path() < first)) {
      first = it->path();
    }
  }
  return first;
}

base::Status read_frames(Dataset& dataset, const DatasetOptions& options) {
  for (const char* name : kAssociationFiles) {
    if (!is_file(dataset.folder / name)) continue;
    dataset.layout = DatasetLayout::associations;
    return read_associations(dataset, dataset.folder / name, options);
  }
  if (is_file(dataset.folder / "rgb.txt") || is_file(dataset.folder / "depth.txt")) {
    dataset.layout = DatasetLayout::lists;
    return read_lists(dataset, options);
  }
  if (is_folder(dataset.folder / "rgb") && is_folder(dataset.folder / "depth")) {
    dataset.layout = DatasetLayout::numbered;
    return read_numbered(dataset, options);
  }
  return base::fail(dataset.folder.string() + ": is no data set: it holds neither rgb.txt and depth.txt, nor " +
                    "associations.txt, nor the folders rgb/ and depth/");
}

}  // namespace

std::string_view to_string(DatasetLayout layout) {
  switch (layout) {
    case DatasetLayout::lists:
      return "rgb.txt and depth.txt";
    case DatasetLayout::associations:
      return "association list";
    case DatasetLayout::numbered:
      return "numbered images";
  }
  return "unknown";
}

base::Result<Dataset> open_dataset(const fs::path& folder, const DatasetOptions& options) {
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return base::fail(folder.string() + ": no such folder");
  if (!is_folder(folder)) return base::fail(folder.string() + ": is not a folder");
  Dataset dataset;
  dataset.folder = folder;
  if (const auto status = read_frames(dataset, options); !status) return tl::make_unexpected(status.error());
  dataset.ground_truth = find_ground_truth(folder);
  return dataset;
}

}  // namespace eg::io
