#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/eval/render.hpp"
#include "common/eval/view.hpp"

/// Lines and text on pictures.
namespace eg::eval {

/// All points of all paths.
std::vector<Eigen::Vector3d> points_of(std::span<const Path> paths);

void draw_line(cv::Mat& image, const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& colour, int thickness);
void draw_path(cv::Mat& image, const Path& path, const OrthographicView& view, int thickness);
void draw_text(cv::Mat& image, const std::string& text, const cv::Point& left_baseline, const cv::Scalar& colour);
/// The paths' labels in their colours, at the top left.
void draw_legend(cv::Mat& image, std::span<const Path> paths);
/// A bar of a round length at the bottom left.
void draw_scale_bar(cv::Mat& image, double pixels_per_metre);

}  // namespace eg::eval
