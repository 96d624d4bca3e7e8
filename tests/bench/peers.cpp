#include "tests/bench/peers.h"

#include <algorithm>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

static cv::Mat prepare(const uint16_t *pixels, int width, int height, int shrink)
{
    cv::Mat photo(height, width, CV_16U, const_cast<uint16_t *>(pixels)), small, grey;
    cv::resize(photo, small, cv::Size(width / shrink, height / shrink), 0, 0, cv::INTER_AREA);
    small.convertTo(grey, CV_8U, 1.0 / 257);
    cv::medianBlur(grey, grey, 5);
    return grey;
}

static std::vector<cv::Vec3f> hough(const cv::Mat &grey, enum peer peer, double low, double high)
{
    std::vector<cv::Vec3f> found;
    if (peer == PEER_HOUGH_GRADIENT)
        cv::HoughCircles(grey, found, cv::HOUGH_GRADIENT, 1, 1.7 * low, 100, 18, (int)low, (int)(high + 1));
    else
        cv::HoughCircles(grey, found, cv::HOUGH_GRADIENT_ALT, 1.5, 1.7 * low, 150, 0.7, (int)low, (int)(high + 1));
    return found;
}

/* Highest points of the distance to the voids, best first, none within another's disc. */
static std::vector<cv::Vec3f> distance_peaks(const cv::Mat &grey, double low)
{
    cv::Mat mask, distance, highest;
    cv::threshold(grey, mask, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(5, 5)));
    cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::dilate(distance, highest, cv::Mat());
    std::vector<cv::Vec3f> peaks, kept;
    for (int y = 0; y < grey.rows; y++)
        for (int x = 0; x < grey.cols; x++)
            if (distance.at<float>(y, x) >= 0.9 * low && distance.at<float>(y, x) == highest.at<float>(y, x))
                peaks.push_back(cv::Vec3f((float)x, (float)y, distance.at<float>(y, x)));
    std::sort(peaks.begin(), peaks.end(), [](const cv::Vec3f &a, const cv::Vec3f &b) { return a[2] > b[2]; });
    for (const cv::Vec3f &peak : peaks) {
        bool clear = true;
        for (const cv::Vec3f &other : kept)
            clear = clear && cv::norm(cv::Point2f(peak[0] - other[0], peak[1] - other[1])) > 0.8 * (peak[2] + other[2]);
        if (clear)
            kept.push_back(peak);
    }
    return kept;
}

int peer_find(enum peer peer, const uint16_t *pixels, int width, int height, int shrink, double radius_min,
              double radius_max, double (*circles)[3], int room)
{
    cv::setNumThreads(1);
    cv::Mat grey = prepare(pixels, width, height, shrink);
    double low = 0.9 * radius_min / shrink, high = 1.1 * radius_max / shrink;
    std::vector<cv::Vec3f> found =
        peer == PEER_DISTANCE_TRANSFORM ? distance_peaks(grey, low) : hough(grey, peer, low, high);
    int count = std::min(room, (int)found.size());
    for (int k = 0; k < count; k++) {
        circles[k][0] = (found[(size_t)k][0] + 0.5) * shrink - 0.5;
        circles[k][1] = (found[(size_t)k][1] + 0.5) * shrink - 0.5;
        circles[k][2] = found[(size_t)k][2] * shrink;
    }
    return count;
}
