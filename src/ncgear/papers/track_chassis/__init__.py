"""Z. Tang, Y. Li, Y. Zhou, H. Zhang: the crank-slider of a baling machine on tracks."""
