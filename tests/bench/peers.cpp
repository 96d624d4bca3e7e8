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

/* White: grains, by Otsu's threshold, small holes closed. */
static cv::Mat grain_mask(const cv::Mat &grey)
{
    cv::Mat mask;
    cv::threshold(grey, mask, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(5, 5)));
    return mask;
}

/* Highest points of the distance to the voids, best first, none within another's disc. */
static std::vector<cv::Vec3f> distance_peaks(const cv::Mat &grey, const cv::Mat &mask, double low)
{
    cv::Mat distance, highest;
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

/* Touching grains parted by a watershed from the peaks of the distance; an ellipse through each one's outline where it
 * borders on a void. */
static std::vector<cv::Vec3f> contour_fits(const cv::Mat &grey, double low)
{
    cv::Mat mask = grain_mask(grey), colour, labels(grey.size(), CV_32S, cv::Scalar(0)), inside;
    std::vector<cv::Vec3f> peaks = distance_peaks(grey, mask, low), found;
    labels.setTo(1, mask == 0);
    for (size_t k = 0; k < peaks.size(); k++)
        cv::circle(labels, cv::Point((int)peaks[k][0], (int)peaks[k][1]), (int)(0.5 * peaks[k][2]), (int)k + 2, -1);
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    cv::watershed(colour, labels);
    cv::erode(mask, inside, cv::Mat(), cv::Point(-1, -1), 2);
    for (size_t k = 0; k < peaks.size(); k++) {
        double reach = 1.6 * peaks[k][2] + 4;
        cv::Rect box((int)(peaks[k][0] - reach), (int)(peaks[k][1] - reach), (int)(2 * reach), (int)(2 * reach));
        box &= cv::Rect(0, 0, grey.cols, grey.rows);
        cv::Mat own = labels(box) == (int)k + 2;
        std::vector<std::vector<cv::Point>> contours;
        std::vector<cv::Point> rim;
        cv::findContours(own, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, box.tl());
        for (const std::vector<cv::Point> &contour : contours)
            for (const cv::Point &point : contour)
                if (!inside.at<unsigned char>(point))
                    rim.push_back(point);
        if (rim.size() < 6)
            continue;
        cv::RotatedRect ellipse = cv::fitEllipse(rim);
        /* the outline runs through the grain's outermost pixels, and the watershed has taken one away all around */
        double radius = 0.25 * (ellipse.size.width + ellipse.size.height) + 1.5;
        found.push_back(cv::Vec3f(ellipse.center.x, ellipse.center.y, (float)radius));
    }
    return found;
}

static std::vector<cv::Vec3f> find(const cv::Mat &grey, enum peer peer, double low, double high)
{
    if (peer == PEER_DISTANCE_TRANSFORM)
        return distance_peaks(grey, grain_mask(grey), low);
    return peer == PEER_CONTOURS ? contour_fits(grey, low) : hough(grey, peer, low, high);
}

int peer_find(enum peer peer, const uint16_t *pixels, int width, int height, int shrink, double radius_min,
              double radius_max, double (*circles)[3], int room)
{
    cv::setNumThreads(1);
    cv::Mat grey = prepare(pixels, width, height, shrink);
    double low = 0.9 * radius_min / shrink, high = 1.1 * radius_max / shrink;
    std::vector<cv::Vec3f> found = find(grey, peer, low, high);
    int count = std::min(room, (int)found.size());
    for (int k = 0; k < count; k++) {
        circles[k][0] = (found[(size_t)k][0] + 0.5) * shrink - 0.5;
        circles[k][1] = (found[(size_t)k][1] + 0.5) * shrink - 0.5;
        circles[k][2] = found[(size_t)k][2] * shrink;
    }
    return count;
}
